#include "structure_limits.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "supple/base/error.h"

namespace supple::design {
namespace {

/// Factor of the relative excess in a residual. A relative excess of 0.001 weighs as much as a deviation of 10 %.
constexpr double penalty_factor = 100;
/// Distance of the penalized limits from the requested ones, as a fraction of the limit. A quadratic penalty allows a
/// small relative excess e at a minimum. It stays below the margin if half the squared deviation changes by at most 10
/// per unit of e.
constexpr double margin = 1e-3;
/// Step of the finite differences, as a fraction of the bounds' widths.
constexpr double step_fraction = 1e-4;

/// Relative excess over a range that is narrower by the margin at both ends: negative below it, positive above it, and
/// zero within it.
double relative_excess(double value, const Range& range) {
  const double min_value = range.least * (1 + margin);
  const double max_value = range.most * (1 - margin);
  // If the range is narrower than both margins, its middle is required.
  if (min_value > max_value) return value / (0.5 * (range.least + range.most)) - 1;
  if (value > max_value) return value / max_value - 1;
  if (value < min_value) return value / min_value - 1;
  return 0;
}

void append_excess(std::ostringstream& text, const char* what, double value, const Range& range) {
  if (value >= range.least && value <= range.most) return;
  text << (text.str().empty() ? "" : " ") << what << " is " << value << ", "
       << (value < range.least ? "below the least one asked for, " : "above the greatest one asked for, ")
       << (value < range.least ? range.least : range.most) << ".";
}

}  // namespace

Eigen::Vector2d LimitResiduals::at(const Eigen::VectorXd& parameters) const {
  const StructureMeasures measures = space_.measure(parameters);
  return penalty_factor * Eigen::Vector2d(relative_excess(measures.relative_density, limits_.relative_density),
                                          relative_excess(measures.cell_size, limits_.cell_size));
}

Eigen::Matrix2Xd LimitResiduals::derivatives(const Eigen::VectorXd& parameters, const std::vector<Eigen::Index>& free,
                                             const Eigen::Vector2d& residuals) const {
  const auto& network = space_.model.network;
  Eigen::Matrix2Xd result = Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(free.size()));
  // The derivatives are zero within the limits, where most designs of a search are.
  if (residuals.isZero(0)) return result;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const Eigen::Index p = free[k];
    if (p == parameters.size()) continue;  // the orientation does not change the measurements
    const double step = step_fraction * (network.upper[p] - network.lower[p]);
    // The second direction is for upper bounds, and for designs beside which nothing can be built.
    for (const double offset : {step, -step}) {
      Eigen::VectorXd shifted = parameters;
      shifted[p] += offset;
      if (shifted[p] > network.upper[p] || shifted[p] < network.lower[p]) continue;
      if (space_.buildable && !space_.buildable(shifted)) continue;
      result.col(static_cast<Eigen::Index>(k)) = (at(shifted) - residuals) / (shifted[p] - parameters[p]);
      break;
    }
  }
  return result;
}

std::string excess(const DesignSpace& space, const StructureLimits& limits, const Eigen::VectorXd& parameters) {
  if (!limits.any()) return {};
  const StructureMeasures measures = space.measure(parameters);
  std::ostringstream text;
  text.precision(4);
  append_excess(text, "Its relative density", measures.relative_density, limits.relative_density);
  append_excess(text, "The size of its cells, in widths of a beam,", measures.cell_size, limits.cell_size);
  return text.str();
}

}  // namespace supple::design
