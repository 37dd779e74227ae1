#include "contact_pairs.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "cell_coordinates.h"
#include "contact_geometry.h"

namespace supple::microscale {
namespace {

/// Least ratio of a pair's distances after and before a step.
constexpr double min_distance_ratio = 0.2;

// Lengths below are in units of the barrier's range.

/// Margin of the list beyond a pair's range. A larger one makes longer but fewer lists.
constexpr double list_margin = 4;
/// Pairs that come this near to their range are included, so that they also suffice for states close to the step.
constexpr double range_slack = 0.02;
/// A step on which two points could approach each other farther than this is shortened, so that the search is local.
constexpr double max_approach = 100;
/// A step with a larger |G| (dimensionless) is shortened, because the bound of approaches requires |G| < 1.
constexpr double max_affine_norm = 0.5;
/// Pairs that are nearer than this at rest touch there.
constexpr double touching_ratio = 1e-6;

}  // namespace

bool ContactPairs::Neighbour::operator<(const Neighbour& other) const {
  return std::tuple(segment, shift[0], shift[1]) < std::tuple(other.segment, other.shift[0], other.shift[1]);
}

ContactPairs::ContactPairs(const tiling::PeriodicMesh& mesh, double range, double rest_fraction)
    : outline_(mesh), range_(range), rest_fraction_(rest_fraction) {}

void ContactPairs::set_range(double range) {
  range_ = range;
  has_list_ = false;
  pairs_.clear();
  joints_.clear();
}

double ContactPairs::prepare(const Eigen::VectorXd& x, const Eigen::VectorXd& step) {
  pairs_.clear();
  joints_.clear();
  if (outline_.segments.empty()) return 1;
  const CellCoordinates coordinates{(x.size() - CellCoordinates::strain_components) / 2};
  start_.gradient = coordinates.deformation_gradient(x);
  gather_displacements(outline_, x, start_.displacement);
  change_.gradient = coordinates.strain_change(step);
  gather_displacements(outline_, step, change_.displacement);
  const bool finite = change_.gradient.allFinite() && change_.displacement.allFinite();
  if (!finite) {
    change_.gradient.setZero();
    change_.displacement.setZero();
  }

  safe_fraction_ = 1;
  if (has_list_) bound_drift();
  if (has_list_ && list_is_complete()) {
    for (int p = 0; p < outline_.points(); ++p) {
      const std::size_t first = pairs_.size();
      const auto point = static_cast<std::size_t>(p);
      for (std::size_t k = list_begin_[point]; k < list_begin_[point + 1]; ++k) add_pair_if_near(p, list_[k]);
      add_joints_from(first);
    }
  } else {
    rebuild_list();
  }
  return finite ? safe_fraction_ : 0;
}

void ContactPairs::bound_drift() {
  affine_norm_ = 0;
  drift_.assign(outline_.nodes.size(), 0.0);
  // G and v are linear along the step, so that their norms are largest at one of its ends.
  Eigen::Matrix2d affine = (start_.gradient - reference_.gradient) * reference_inverse_;
  relative_displacement_ = start_.displacement - reference_.displacement;
  relative_displacement_.noalias() -= affine * reference_.displacement;
  raise_drift_bounds(affine);
  const Eigen::Matrix2d affine_change = change_.gradient * reference_inverse_;
  affine += affine_change;
  relative_displacement_ += change_.displacement;
  relative_displacement_.noalias() -= affine_change * reference_.displacement;
  raise_drift_bounds(affine);
  largest_drift_ = *std::max_element(drift_.begin(), drift_.end());
}

void ContactPairs::raise_drift_bounds(const Eigen::Matrix2d& affine) {
  affine_norm_ = std::max(affine_norm_, affine.norm());
  const Eigen::Vector2d mean = relative_displacement_.rowwise().mean();
  for (int p = 0; p < outline_.points(); ++p) {
    double& drift = drift_[static_cast<std::size_t>(p)];
    drift = std::max(drift, (relative_displacement_.col(p) - mean).norm());
  }
}

bool ContactPairs::list_is_complete() const {
  // At the reference state, the distance of a pair that is not listed exceeded its range by more than the margin.
  const double margin = list_margin * range_;
  return margin - affine_norm_ * (range_ + margin) - 2 * largest_drift_ >= range_slack * range_;
}

void ContactPairs::rebuild_list() {
  reference_ = start_;
  reference_inverse_ = reference_.gradient.inverse();
  reference_lattice_ = reference_.gradient * outline_.lattice;
  reference_positions_ = reference_.displacement;
  reference_positions_.noalias() += reference_.gradient * outline_.rest;
  has_list_ = true;
  bound_drift();

  if (affine_norm_ > max_affine_norm) safe_fraction_ = max_affine_norm / affine_norm_;
  if (2 * largest_drift_ > max_approach * range_)
    safe_fraction_ = std::min(safe_fraction_, max_approach * range_ / (2 * largest_drift_));
  if (safe_fraction_ < 1) {
    change_.gradient *= safe_fraction_;
    change_.displacement *= safe_fraction_;
    bound_drift();
  }
  const double step_fraction = safe_fraction_;
  // From here on, safe_fraction_ is a fraction of the shortened step.
  safe_fraction_ = 1;

  grid_.build(outline_, reference_lattice_, reference_positions_, (1 + list_margin) * range_);
  list_.clear();
  list_begin_.clear();
  for (int p = 0; p < outline_.points(); ++p) {
    list_begin_.push_back(list_.size());
    const std::size_t first = pairs_.size();
    find_neighbours(p);
    for (const Neighbour& neighbour : neighbours_) {
      if (neighbour.distance <= neighbour.range + list_margin * range_) list_.push_back(neighbour);
      add_pair_if_near(p, neighbour);
    }
    add_joints_from(first);
  }
  list_begin_.push_back(list_.size());
  safe_fraction_ *= step_fraction;
}

void ContactPairs::find_neighbours(int point) {
  neighbours_.clear();
  const Eigen::Vector2d position = reference_positions_.col(point);
  // Radius in which the list needs neighbours, and that in which segments can come near on this step.
  const double listed = (1 + list_margin) * range_;
  const auto reach = [&](double other_drift) {
    const double drift = drift_[static_cast<std::size_t>(point)] + other_drift;
    return std::max(listed, ((1 + range_slack) * range_ + drift) / (1 - affine_norm_));
  };
  grid_.visit(position, reach(largest_drift_), [&](int index, const Eigen::Vector2i& shift) {
    const ContactOutline::Segment& segment = outline_.segments[static_cast<std::size_t>(index)];
    const Eigen::Vector2i head_shift = shift + segment.head_shift;
    if ((segment.tail == point && shift.isZero()) || (segment.head == point && head_shift.isZero())) return;
    const Eigen::Vector2d tail =
        reference_positions_.col(segment.tail) + reference_lattice_ * shift.cast<double>() - position;
    const Eigen::Vector2d head =
        reference_positions_.col(segment.head) + reference_lattice_ * head_shift.cast<double>() - position;
    const double squared_distance = point_segment_distance(tail, head).squared_distance;
    const double own_reach = reach(segment_drift(segment));
    if (squared_distance > own_reach * own_reach) return;
    const double range = pair_range(point, segment, shift);
    if (range > 0) neighbours_.push_back({index, shift, range, std::sqrt(squared_distance)});
  });
  std::sort(neighbours_.begin(), neighbours_.end());
}

double ContactPairs::segment_drift(const ContactOutline::Segment& segment) const {
  return std::max(drift_[static_cast<std::size_t>(segment.tail)], drift_[static_cast<std::size_t>(segment.head)]);
}

double ContactPairs::pair_range(int point, const ContactOutline::Segment& segment, const Eigen::Vector2i& shift) const {
  const Eigen::Vector2d tail = outline_.rest_tail(segment, shift) - outline_.rest.col(point);
  const Eigen::Vector2d head = outline_.rest_head(segment, shift) - outline_.rest.col(point);
  const double distance = std::sqrt(point_segment_distance(tail, head).squared_distance);
  if (distance < touching_ratio * range_) return 0;
  return std::min(range_, rest_fraction_ * distance);
}

void ContactPairs::add_pair_if_near(int point, const Neighbour& neighbour) {
  const ContactOutline::Segment& segment = outline_.segments[static_cast<std::size_t>(neighbour.segment)];
  const auto p = static_cast<std::size_t>(point);
  const double reach = neighbour.range + range_slack * range_;
  if (neighbour.distance * (1 - affine_norm_) - drift_[p] - segment_drift(segment) > reach) return;

  ContactPair pair;
  pair.tail_shift = neighbour.shift;
  pair.head_shift = neighbour.shift + segment.head_shift;
  pair.rest_tail = outline_.rest_tail(segment, neighbour.shift) - outline_.rest.col(point);
  pair.rest_head = outline_.rest_head(segment, neighbour.shift) - outline_.rest.col(point);
  const auto relative = [&](const Deformation& deformation, int end, const Eigen::Vector2d& rest) {
    return Eigen::Vector2d(deformation.gradient * rest + deformation.displacement.col(end) -
                           deformation.displacement.col(point));
  };
  const Eigen::Vector2d tail = relative(start_, segment.tail, pair.rest_tail);
  const Eigen::Vector2d head = relative(start_, segment.head, pair.rest_head);
  const Eigen::Vector2d tail_change = relative(change_, segment.tail, pair.rest_tail);
  const Eigen::Vector2d head_change = relative(change_, segment.head, pair.rest_head);
  if (stays_beyond(tail, head, tail_change, head_change, reach)) return;
  safe_fraction_ = conservative_ccd_step(tail, head, tail_change, head_change, min_distance_ratio, safe_fraction_);
  pair.point = outline_.nodes[p];
  pair.tail = outline_.nodes[static_cast<std::size_t>(segment.tail)];
  pair.head = outline_.nodes[static_cast<std::size_t>(segment.head)];
  pair.segment = neighbour.segment;
  pair.range = neighbour.range;
  pair.length = outline_.lengths[p];
  pairs_.push_back(pair);
}

void ContactPairs::add_joints_from(std::size_t first) {
  for (std::size_t i = first; i < pairs_.size(); ++i) {
    ContactPair& before = pairs_[i];
    const int next = outline_.segments[static_cast<std::size_t>(before.segment)].next;
    if (next < 0) continue;
    const auto after = std::find_if(
        pairs_.begin() + static_cast<std::ptrdiff_t>(first), pairs_.end(),
        [&](const ContactPair& pair) { return pair.segment == next && pair.tail_shift == before.head_shift; });
    if (after == pairs_.end()) continue;
    const double range = std::min(before.range, after->range);
    before.head_joint = before.range == range;
    after->tail_joint = after->range == range;
    joints_.push_back({static_cast<int>(i), static_cast<int>(after - pairs_.begin()), range});
  }
}

}  // namespace supple::microscale
