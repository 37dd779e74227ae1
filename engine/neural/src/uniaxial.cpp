#include "supple/neural/uniaxial.h"

#include <cmath>
#include <string>

#include "supple/base/error.h"
#include "supple/base/number_text.h"

namespace supple::neural {
namespace {

UniaxialState state_of(const UniaxialNewton& newton) {
  UniaxialState state;
  state.strain = newton.strain();
  state.stress = newton.point().stress;
  state.directional_stress = newton.frame().directional(state.stress);
  state.energy_density = newton.point().energy_density;
  state.tangent = newton.point().tangent;
  state.converged = newton.converged();
  state.residual = newton.residual();
  state.iterations = newton.iterations();
  return state;
}

/// The result if no finite energy was found. It contains the numbers that are not finite, so that it cannot be mistaken
/// for a state.
UniaxialState overflowed(const UniaxialNewton& newton, const UniaxialPoint& last) {
  UniaxialState state = state_of(newton);
  state.stress = last.stress;
  state.directional_stress = newton.frame().directional(last.stress);
  state.energy_density = last.energy_density;
  return state;
}

}  // namespace

template <class Real>
std::vector<UniaxialState> uniaxial_path(const BasicEvaluator<Real>& evaluator,
                                         const typename BasicEvaluator<Real>::Design& design, double direction,
                                         std::span<const double> green_strains, const UniaxialOptions& options,
                                         const Execution& execution) {
  for (std::size_t i = 0; i < green_strains.size(); ++i)
    if (!(green_strains[i] > -0.5) || !std::isfinite(green_strains[i]))
      throw Error("model.invalid_load", "A Green strain along the load must be above -0.5, where the length vanishes.",
                  {{"green_strains/" + std::to_string(i), "> -0.5, got " + number_text(green_strains[i])}});
  typename BasicEvaluator<Real>::Workspace workspace;
  Evaluation evaluation;
  const auto evaluate_at = [&](const Eigen::Vector3d& strain) -> UniaxialPoint {
    evaluator.evaluate(design, strain, Order::tangent, workspace, evaluation);
    return {evaluation.energy_density[0], evaluation.stress.col(0), symmetric_matrix(evaluation.tangent.col(0))};
  };
  UniaxialNewton newton{UniaxialFrame(direction), options};
  newton.start_from_rest(evaluate_at(newton.strain()));
  std::vector<UniaxialState> states;
  states.reserve(green_strains.size());
  for (const double strain : green_strains) {
    execution.checkpoint(static_cast<double>(states.size()) / static_cast<double>(green_strains.size()), "equilibrium");
    newton.go_to(strain);
    UniaxialPoint last;
    while (newton.working()) {
      execution.cancellation.throw_if_requested();
      last = evaluate_at(newton.trial());
      newton.receive(last);
    }
    states.push_back(newton.converged() || last.finite() ? state_of(newton) : overflowed(newton, last));
  }
  return states;
}

template std::vector<UniaxialState> uniaxial_path(const BasicEvaluator<double>&, const BasicEvaluator<double>::Design&,
                                                  double, std::span<const double>, const UniaxialOptions&,
                                                  const Execution&);
template std::vector<UniaxialState> uniaxial_path(const BasicEvaluator<float>&, const BasicEvaluator<float>::Design&,
                                                  double, std::span<const double>, const UniaxialOptions&,
                                                  const Execution&);

}  // namespace supple::neural
