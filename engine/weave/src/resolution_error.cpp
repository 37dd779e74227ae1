#include "resolution_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "direction_sweep.h"

namespace supple::weave {
namespace {

constexpr double millimetres_per_metre = 1000;
/// Maximum number of directions that are compared if the switch is automatic. They are then 0.13 rad apart over half a
/// turn, near enough for neighbours to be compared as in the answer itself.
constexpr std::size_t max_compared = 24;
/// Ratios of the estimated errors to differences. Errors of few segments do not fall with the square of their number
/// yet.
constexpr double factor_of_many = 1.25;
constexpr double factor_of_one = 3;
constexpr double factor_of_two = 2;
/// Beyond these for Poisson's ratio, whose error changes its sign with the resolution in some directions, so that both
/// resolutions can agree by chance.
constexpr double poisson_factor = 2;

/// What the rods' resolution makes of error in one direction; NaN where that is unknown.
struct ResolutionDifference {
  double modulus = std::numeric_limits<double>::quiet_NaN();   ///< N/m
  double relative = std::numeric_limits<double>::quiet_NaN();  ///< modulus over Young's modulus, at most 1
  double poisson = std::numeric_limits<double>::quiet_NaN();
};

ResolutionDifference difference_of(const DirectionalResponse& response, const DirectionalResponse& compared,
                                   double factor) {
  ResolutionDifference difference;
  difference.modulus = factor * std::abs(response.youngs_modulus - compared.youngs_modulus);
  if (std::isnan(difference.modulus)) return difference;
  const double modulus = std::abs(response.youngs_modulus);
  difference.relative = difference.modulus < modulus ? difference.modulus / modulus : 1;
  difference.poisson = poisson_factor * factor * std::abs(response.poisson_ratio - compared.poisson_ratio);
  return difference;
}

/// The larger of two values, or the one that is known.
ResolutionDifference larger_difference(const ResolutionDifference& a, const ResolutionDifference& b) {
  return {std::fmax(a.modulus, b.modulus), std::fmax(a.relative, b.relative), std::fmax(a.poisson, b.poisson)};
}

}  // namespace

OtherResolution other_resolution(const EquilibriumOptions& options) {
  OtherResolution other{options, factor_of_many};
  if (options.segments == 1) {
    other.equilibrium.segments = 2;
    other.equilibrium.max_segment_turn /= 2;
    other.factor = factor_of_one;
  } else {
    other.equilibrium.segments /= 2;
    other.equilibrium.max_segment_turn *= 2;
    if (options.segments == 2) other.factor = factor_of_two;
  }
  return other;
}

std::vector<std::size_t> compared_positions(std::size_t total, Switch error_estimate) {
  const std::size_t count = error_estimate == Switch::on ? total : std::min(total, max_compared);
  std::vector<std::size_t> positions;
  positions.reserve(count);
  for (std::size_t k = 0; k < count; ++k) positions.push_back(k * total / count);
  return positions;
}

std::vector<std::size_t> compared_directions(const std::vector<DirectionalResponse>& responses, Switch error_estimate) {
  const DirectionOrder order(responses);
  std::vector<std::size_t> indices = compared_positions(order.size(), error_estimate);
  for (std::size_t& index : indices) index = order.index(index);
  return indices;
}

void set_errors(const std::vector<std::size_t>& at, const std::vector<DirectionalResponse>& compared, double factor,
                double area, const HomogenizationOptions& options, std::vector<DirectionalResponse>& responses) {
  std::vector<ResolutionDifference> differences;
  differences.reserve(at.size());
  for (std::size_t k = 0; k < at.size(); ++k)
    differences.push_back(difference_of(responses[at[k]], compared[k], factor));
  const DirectionOrder order(responses);
  // The direction before a position that is compared, and the one at it or after it. The last one is before the first.
  std::size_t before = at.size() - 1;
  std::size_t after = 0;
  for (std::size_t position = 0; position < order.size(); ++position) {
    DirectionalResponse& response = responses[order.index(position)];
    const bool is_compared = after < at.size() && at[after] == order.index(position);
    const ResolutionDifference difference =
        is_compared ? differences[after] : larger_difference(differences[before], differences[after % at.size()]);
    if (is_compared) before = after++;
    // A residual of the size of the tolerance, on which the cell yields by its own length.
    const double tolerance =
        millimetres_per_metre * response.state.tolerance / std::sqrt(area) / std::abs(options.strain);
    const double modulus = std::abs(response.youngs_modulus);
    response.youngs_modulus_error =
        std::max(difference.modulus, difference.relative * modulus) + response.state.limit_error * modulus + tolerance;
    response.poisson_ratio_error = difference.poisson + (tolerance < modulus ? tolerance / modulus : 1);
    if (std::isnan(response.youngs_modulus)) response.youngs_modulus_error = response.youngs_modulus;
    if (std::isnan(response.poisson_ratio)) response.poisson_ratio_error = response.poisson_ratio;
  }
}

void set_errors(const std::vector<std::size_t>& at, const std::vector<CellState>& compared, double factor,
                std::vector<CellState>& states) {
  for (std::size_t k = 0; k < at.size(); ++k) {
    CellState& state = states[at[k]];
    const CellState& other = compared[k];
    if (state.stopped != Stop::converged || other.stopped != Stop::converged) continue;
    state.stress_error =
        factor * (state.cauchy_stress - other.cauchy_stress).norm() + state.limit_error * state.cauchy_stress.norm();
    state.energy_error =
        factor * std::abs(state.energy_density - other.energy_density) + state.limit_error * state.energy_density;
  }
}

void EstimateTimer::bill(const Compared& compared) const {
  if (!cost_) return;
  if (compared.count == 0) return bill_estimate_without_time(cost_);
  cost_->add_effect("error_estimate", true,
                    std::to_string(compared.count) + " of " + std::to_string(compared.total) + " " +
                        std::string(compared.entries) + " were computed once more, with " +
                        std::to_string(compared.segments) + " segments",
                    static_cast<std::int64_t>(compared.count), seconds());
}

void bill_no_estimate(Switch error_estimate, CostLedger* cost) {
  if (!cost) return;
  cost->add_effect("error_estimate", false,
                   error_estimate == Switch::off ? "switched off by the request"
                                                 : "a sheet is computed once more only where the request asks for it");
}

void bill_estimate_without_time(CostLedger* cost) {
  if (cost) cost->add_effect("error_estimate", false, "time or memory ran out before");
}

}  // namespace supple::weave
