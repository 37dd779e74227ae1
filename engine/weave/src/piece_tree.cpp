#include "piece_tree.h"

#include <algorithm>

namespace supple::weave {
namespace {

/// Maximum number of pieces in a leaf, which a search compares one by one.
constexpr std::int32_t max_leaf_pieces = 8;
/// A branch of more pieces checks for a stop request before it is sorted.
constexpr std::int32_t pieces_between_checks = 4096;
/// Margin of a piece's box as a fraction of the curve's length: a point this close to the end of a piece lies on it.
constexpr double piece_end_tolerance = 1e-9;
/// Margin of the box of a straight strand, as a fraction of its length, for rounding.
constexpr double straight_margin = 1e-6;

}  // namespace

std::vector<Eigen::AlignedBox2d> piece_boxes(const StrandCurve& curve) {
  const std::vector<double>& knots = curve.knots();
  std::vector<Eigen::AlignedBox2d> result;
  result.reserve(knots.size() - 1);
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const auto begin = curve.at(knots[i]);
    Eigen::AlignedBox2d box(begin.position);
    // The end of the piece comes from its own polynomial: `at` would evaluate the next piece, and at the end of a loop
    // its beginning.
    const double h = knots[i + 1] - knots[i];
    box.extend(begin.position + h * (begin.first + h / 2 * (begin.second + h / 3 * begin.third)));
    // The distance of a piece from its chord is less than an eighth of its length times its turning angle, and this
    // angle is small.
    const double chord_distance = curve.straight() ? straight_margin * h : h / 16;
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(chord_distance + piece_end_tolerance * curve.length());
    result.emplace_back(box.min() - margin, box.max() + margin);
  }
  return result;
}

PieceTree::PieceTree(const std::vector<Strand>& strands, const Execution& execution) {
  for (std::size_t s = 0; s < strands.size(); ++s) {
    execution.cancellation.throw_if_requested();
    const std::vector<Eigen::AlignedBox2d> boxes = piece_boxes(strands[s].curve);
    for (std::size_t i = 0; i < boxes.size(); ++i)
      entries_.push_back({boxes[i], static_cast<std::int32_t>(s), static_cast<std::int32_t>(i)});
  }
  branches_.push_back({{}, 0, 0, static_cast<std::int32_t>(entries_.size()), 0});
  divide(0, execution);
}

void PieceTree::divide(std::int32_t branch, const Execution& execution) {
  const auto number = static_cast<std::size_t>(branch);
  const std::int32_t first = branches_[number].first;
  const std::int32_t end = branches_[number].end;
  if (end - first > pieces_between_checks) execution.cancellation.throw_if_requested();
  Eigen::AlignedBox2d box;
  std::int32_t last_strand = -1;
  for (std::int32_t i = first; i < end; ++i) {
    box.extend(entries_[static_cast<std::size_t>(i)].box);
    last_strand = std::max(last_strand, entries_[static_cast<std::size_t>(i)].strand);
  }
  branches_[number].box = box;
  branches_[number].last_strand = last_strand;
  if (end - first <= max_leaf_pieces) return;
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::int32_t middle = first + (end - first) / 2;
  std::nth_element(entries_.begin() + first, entries_.begin() + middle, entries_.begin() + end,
                   [axis](const Entry& a, const Entry& b) {
                     return a.box.min()[axis] + a.box.max()[axis] < b.box.min()[axis] + b.box.max()[axis];
                   });
  const auto children = static_cast<std::int32_t>(branches_.size());
  branches_[number].children = children;
  branches_.push_back({{}, 0, first, middle, 0});
  branches_.push_back({{}, 0, middle, end, 0});
  divide(children, execution);
  divide(children + 1, execution);
}

}  // namespace supple::weave
