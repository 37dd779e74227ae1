#include "supple/neural/error_bars.h"

namespace supple::neural {

ErrorBars::ErrorBars(const Model& model, const Evaluator& evaluator, const Evaluator::Design& design,
                     std::span<const double> parameters, bool with_uniaxial, Origin origin)
    : model_(model),
      parameters_(parameters.begin(), parameters.end()),
      origin_(origin),
      rest_stiffness_(design.rest_stiffness()) {
  if (!model.calibration) return;
  if (!with_uniaxial) {
    features_ = design_features(model.network, parameters, rest_stiffness_);
    return;
  }
  const auto rest = evaluator.evaluate(design, Eigen::Vector3d::Zero(), Order::tangent);
  features_ = design_features(model.network, parameters, rest_stiffness_, symmetric_matrix(rest.tangent.col(0)));
}

Trust ErrorBars::uniaxial(Quantity quantity, const UniaxialFrame& frame, double axial_strain,
                          const Eigen::Vector3d& strain, const UniaxialPoint& point) const {
  if (!in_box(strain, point.energy_density)) return {};
  if (!model_.calibration) return {true, {}};
  return trust(quantity, uniaxial_features(features_, frame, axial_strain, strain, point));
}

Trust ErrorBars::at_strain(const Eigen::Vector3d& strain, double energy_density, const Eigen::Vector3d& stress) const {
  if (!in_box(strain, energy_density)) return {};
  if (!model_.calibration) return {true, {}};
  return trust(Quantity::stress_at_strain, strain_features(features_, strain, energy_density, stress));
}

bool ErrorBars::in_box(const Eigen::Vector3d& strain, double energy_density) const {
  return in_range(model_, parameters_, strain, energy_density, rest_stiffness_);
}

Trust ErrorBars::trust(Quantity quantity, const Eigen::VectorXd& features) const {
  // If the tangent is not finite, the error is not known.
  if (!features.allFinite()) return {};
  const double error = expected_error(*model_.calibration, quantity, features, origin_);
  return {error <= max_trusted_error(quantity), error};
}

}  // namespace supple::neural
