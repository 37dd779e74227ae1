#include "structure_limits.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "supple/base/error.h"

namespace supple::design {
namespace {

/// A relative excess of 0.001 weighs as much as a deviation of 10 %.
constexpr double penalty = 100;
/// Of each limit, as a share of it: an excess of that much is what a slope of 10 would still hold against the penalty.
constexpr double margin = 1e-3;
/// Of differences, as a share of the bounds' widths.
constexpr double step_share = 1e-4;

/// Zero within a range that is narrower by the margin, negative below it and positive beyond it; relative.
double relative_excess(double value, const Range& range) {
  const double least = range.least * (1 + margin);
  const double most = range.most * (1 - margin);
  // A range narrower than the margins is met in its middle.
  if (least > most) return value / (0.5 * (range.least + range.most)) - 1;
  if (value > most) return value / most - 1;
  if (value < least) return value / least - 1;
  return 0;
}

void tell(std::ostringstream& text, const char* what, double value, const Range& range) {
  if (value >= range.least && value <= range.most) return;
  text << (text.str().empty() ? "" : " ") << what << " is " << value << ", "
       << (value < range.least ? "below the least one asked for, " : "above the greatest one asked for, ")
       << (value < range.least ? range.least : range.most) << ".";
}

}  // namespace

Eigen::Vector2d LimitRows::at(const Eigen::VectorXd& parameters) const {
  const StructureMeasures measures = space_.measure(parameters);
  return penalty * Eigen::Vector2d(relative_excess(measures.relative_density, limits_.relative_density),
                                   relative_excess(measures.cell_size, limits_.cell_size));
}

Eigen::Matrix2Xd LimitRows::derivatives(const Eigen::VectorXd& parameters, const std::vector<Eigen::Index>& free,
                                        const Eigen::Vector2d& rows) const {
  const auto& network = space_.model.network;
  Eigen::Matrix2Xd result = Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(free.size()));
  // Within the limits, where searches are nearly always, there is nothing to push back.
  if (rows.isZero(0)) return result;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const Eigen::Index p = free[k];
    if (p == parameters.size()) continue;  // turned, a structure measures the same
    const double step = step_share * (network.upper[p] - network.lower[p]);
    // At an upper bound, and next to places that cannot be built, the other side is taken.
    for (const double by : {step, -step}) {
      Eigen::VectorXd there = parameters;
      there[p] += by;
      if (there[p] > network.upper[p] || there[p] < network.lower[p]) continue;
      if (space_.buildable && !space_.buildable(there)) continue;
      result.col(static_cast<Eigen::Index>(k)) = (at(there) - rows) / (there[p] - parameters[p]);
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
  tell(text, "Its relative density", measures.relative_density, limits.relative_density);
  tell(text, "The size of its cells, in widths of a beam,", measures.cell_size, limits.cell_size);
  return text.str();
}

}  // namespace supple::design
