#pragma once

#include <optional>
#include <span>
#include <vector>

#include "supple/neural/error_features.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/model.h"

namespace supple::neural {

/// How far an answer can be trusted.
struct Trust {
  /// Whether the state lies within the ranges of training (neural::in_range) and, if the model has error bars, its bar
  /// is at most trusted_error.
  bool in_range = false;
  /// The error bar, as in Quantity. None if the model has no calibration, or if the state lies outside of the ranges of
  /// training, where there are no simulations to compare with.
  std::optional<double> error;
};

/// The error bars of one design of a model. Model and design must outlive it. Several threads may use it at once.
class ErrorBars {
 public:
  /// `with_uniaxial` prepares it for `uniaxial`. This costs one evaluation with the tangent if the model has a
  /// calibration. `origin` says how the design was chosen, because a search leads to where a network errs.
  ErrorBars(const Model& model, const Evaluator& evaluator, const Evaluator::Design& design,
            std::span<const double> parameters, bool with_uniaxial, Origin origin = Origin::given);

  /// The error bar of a quantity at a uniaxial equilibrium. `given` is d^T E d, `strain` the whole strain there, and
  /// `point` the network's answer. `quantity` must not be stress_at_strain. Takes about 2 microseconds.
  Trust uniaxial(Quantity quantity, const UniaxialFrame& frame, double given, const Eigen::Vector3d& strain,
                 const UniaxialPoint& point) const;

  /// The error bar of the stress at a strain (E_xx, E_yy, 2 E_xy). Takes about a microsecond.
  Trust at_strain(const Eigen::Vector3d& strain, double energy_density, const Eigen::Vector3d& stress) const;

 private:
  bool in_box(const Eigen::Vector3d& strain, double energy_density) const;
  Trust trust(Quantity quantity, const Eigen::VectorXd& features) const;

  const Model& model_;
  std::vector<double> parameters_;
  Origin origin_;
  double rest_stiffness_ = 1;
  DesignFeatures features_;  ///< where the model has a calibration
};

}  // namespace supple::neural
