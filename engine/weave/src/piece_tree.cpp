#include "piece_tree.h"

#include <algorithm>

namespace supple::weave {
namespace {

/// Pieces that are looked through one by one.
constexpr std::int32_t pieces_of_a_leaf = 8;
/// Fewer take less time to sort than anyone waits for a stop.
constexpr std::int32_t pieces_between_looks = 4096;
/// A point lies on a piece's end within this share of its curve's length.
constexpr double piece_end = 1e-9;
/// A straight strand has one piece, which lies within its box up to rounding.
constexpr double straight_margin = 1e-6;

}  // namespace

std::vector<Eigen::AlignedBox2d> piece_boxes(const StrandCurve& curve) {
  const std::vector<double>& knots = curve.knots();
  std::vector<Eigen::AlignedBox2d> result;
  result.reserve(knots.size() - 1);
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const auto begin = curve.at(knots[i]);
    Eigen::AlignedBox2d box(begin.position);
    // A piece's last point by its own polynomial: the next piece's is the same, and beyond the last one a loop repeats.
    const double h = knots[i + 1] - knots[i];
    box.extend(begin.position + h * (begin.first + h / 2 * (begin.second + h / 3 * begin.third)));
    // Pieces turn by little: they leave their chord by less than an eighth of their length times the turn.
    const double leaves_chord = curve.straight() ? straight_margin * h : h / 16;
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(leaves_chord + piece_end * curve.length());
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
  if (end - first > pieces_between_looks) execution.cancellation.throw_if_requested();
  Eigen::AlignedBox2d box;
  std::int32_t last_strand = -1;
  for (std::int32_t i = first; i < end; ++i) {
    box.extend(entries_[static_cast<std::size_t>(i)].box);
    last_strand = std::max(last_strand, entries_[static_cast<std::size_t>(i)].strand);
  }
  branches_[number].box = box;
  branches_[number].last_strand = last_strand;
  if (end - first <= pieces_of_a_leaf) return;
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
