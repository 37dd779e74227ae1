#include <algorithm>
#include <cmath>

#include "supple/design/target_ranges.h"

namespace supple::design {
namespace {

/// Strains of a smaller magnitude are those of rest.
constexpr double max_rest_strain = 1e-9;
/// Slope of a plateau, as a fraction of the steepest slope before it.
constexpr double max_plateau_slope = 0.4;
/// Mean slope of a rise, as a fraction of the steepest slope of the curve.
constexpr double min_rise_slope = 0.6;
/// Slope of a drop, as a fraction of the steepest slope before it.
constexpr double max_drop_slope = -0.1;
/// Slope of a part that stiffens, as a multiple of the mean slope before it.
constexpr double min_stiffening_slope = 1.5;

/// The samples on one side of rest, counted away from it.
struct Branch {
  std::vector<double> strain;  ///< magnitudes
  std::vector<double> stress;  ///< negative where its sign is not that of the strain

  double slope(std::size_t a, std::size_t b) const { return (stress[b] - stress[a]) / (strain[b] - strain[a]); }
  double slope_around(std::size_t a, std::size_t b) const {
    if (a < b) return slope(a, b);
    return slope(a > 0 ? a - 1 : 0, std::min(a + 1, strain.size() - 1));
  }
  double steepest_before(std::size_t end) const {
    double steepest = slope(0, 1);
    for (std::size_t i = 1; i < end; ++i) steepest = std::max(steepest, slope(i, i + 1));
    return steepest;
  }
};

Branch branch_of(const SampledTarget& target, bool tension) {
  Branch branch;
  const auto& x = target.samples.x;
  const double sign = tension ? 1 : -1;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::size_t i = tension ? k : x.size() - 1 - k;
    if (sign * x[i] < -max_rest_strain) continue;
    branch.strain.push_back(std::abs(x[i]));
    branch.stress.push_back(sign * target.y[static_cast<Eigen::Index>(i)]);
  }
  return branch;
}

/// A part of a branch that ends before it does or begins after it. It has at least 2 samples in all.
CurvePart part_of_branch(const Branch& branch, std::size_t first, std::size_t last) {
  const std::size_t end = branch.strain.size() - 1;
  const double slope = branch.slope_around(first, last);
  if (first == 0)
    return slope > 0 && slope >= min_rise_slope * branch.steepest_before(end) ? CurvePart::rise : CurvePart::beginning;
  const double steepest = std::max(0.0, branch.steepest_before(first));
  if (slope < 0 && slope < max_drop_slope * steepest) return CurvePart::drop;
  if (slope <= max_plateau_slope * steepest) return CurvePart::plateau;
  if (slope >= min_stiffening_slope * branch.slope(0, first)) return CurvePart::stiffening;
  return last == end ? CurvePart::end : CurvePart::middle;
}

}  // namespace

std::string_view to_string(CurvePart part) {
  switch (part) {
    case CurvePart::whole:
      return "whole";
    case CurvePart::compression:
      return "compression";
    case CurvePart::tension:
      return "tension";
    case CurvePart::around_rest:
      return "around_rest";
    case CurvePart::beginning:
      return "beginning";
    case CurvePart::rise:
      return "rise";
    case CurvePart::plateau:
      return "plateau";
    case CurvePart::stiffening:
      return "stiffening";
    case CurvePart::drop:
      return "drop";
    case CurvePart::middle:
      return "middle";
    case CurvePart::end:
      return "end";
    case CurvePart::directions:
      return "directions";
  }
  return "";
}

CurvePart part_of(const SampledTarget& target, std::size_t first, std::size_t last) {
  if (target.samples.task != Task::stress_strain) return CurvePart::directions;
  const auto& x = target.samples.x;
  if (first == 0 && last + 1 == x.size()) return CurvePart::whole;
  const bool tension = x[first] >= -max_rest_strain;
  const bool is_at_rest = tension && x[last] <= max_rest_strain;
  if (is_at_rest || (!tension && x[last] > max_rest_strain)) return CurvePart::around_rest;
  const Branch branch = branch_of(target, tension);
  const std::size_t before = x.size() - branch.strain.size();
  std::size_t from = tension ? first - before : branch.strain.size() - 1 - last;
  const std::size_t to = tension ? last - before : branch.strain.size() - 1 - first;
  // Rest itself may belong to the range on its other side.
  if (from == 1 && branch.strain[0] <= max_rest_strain) from = 0;
  if (from == 0 && to + 1 == branch.strain.size()) {
    const bool has_other_side = tension ? x.front() < -max_rest_strain : x.back() > max_rest_strain;
    return !has_other_side ? CurvePart::whole : tension ? CurvePart::tension : CurvePart::compression;
  }
  return part_of_branch(branch, from, to);
}

}  // namespace supple::design
