#include "supple/neural/uniaxial_curve.h"

#include <cmath>
#include <string>

#include "supple/base/error.h"

namespace supple::neural {
namespace {

void check_finite(const std::vector<UniaxialState>& states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& state = states[i];
    if (state.strain.allFinite() && state.stress.allFinite() && std::isfinite(state.energy_density)) continue;
    throw Error("model.not_finite", "The model gives no finite value at state " + std::to_string(i) + " of the load.");
  }
}

}  // namespace

UniaxialCurve uniaxial_curve(const Model& model, const Evaluator& evaluator, const std::vector<double>& parameters,
                             double direction, std::span<const double> green_strains, const UniaxialOptions& options,
                             const Execution& execution) {
  const auto design = evaluator.design(parameters);
  UniaxialCurve curve;
  {
    const StageTimer timer(execution.cost, "equilibrium");
    curve.states = uniaxial_path(evaluator, design, direction, green_strains, options, execution);
  }
  check_finite(curve.states);
  const ErrorBars bars(model, evaluator, design, parameters, true);
  const UniaxialFrame frame(direction);
  int iterations = 0;
  for (std::size_t i = 0; i < curve.states.size(); ++i) {
    const auto& state = curve.states[i];
    iterations += state.iterations;
    auto& trust = curve.trust.emplace_back(bars.uniaxial(Quantity::stress, frame, green_strains[i], state.strain,
                                                         {state.energy_density, state.stress, state.tangent}));
    // Error bars refer to equilibria only.
    if (!state.converged) trust.error.reset();
  }
  if (execution.cost) execution.cost->add_quantity("iterations", iterations);
  execution.checkpoint(1, "");
  return curve;
}

}  // namespace supple::neural
