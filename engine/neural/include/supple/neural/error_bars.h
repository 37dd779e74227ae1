#pragma once

#include <optional>
#include <span>
#include <vector>

#include "supple/neural/error_features.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/model.h"

namespace supple::neural {

/// How far an answer is to be trusted.
struct Trust {
  /// Within the ranges of training (neural::in_range) and, where the model has error bars, with one of at most
  /// trusted_error.
  bool in_range = false;
  /// As in Quantity; none where the model has no calibration or the state lies outside of the ranges of training, of
  /// which no simulation can tell.
  std::optional<double> error;
};

/// The error bars of one design of a model. Both outlive it; any number of threads may ask at once.
class ErrorBars {
 public:
  /// `with_uniaxial` makes it ready for `uniaxial`, at one evaluation with the tangent where the model has a
  /// calibration.
  ErrorBars(const Model& model, const Evaluator& evaluator, const Evaluator::Design& design,
            std::span<const double> parameters, bool with_uniaxial);

  /// At a uniaxial equilibrium: `given` is d^T E d, `strain` the whole strain there, `point` the network's answer.
  /// `quantity` is not stress_at_strain. About 2 microseconds.
  Trust uniaxial(Quantity quantity, const UniaxialFrame& frame, double given, const Eigen::Vector3d& strain,
                 const UniaxialPoint& point) const;

  /// Of the stress at a strain (E_xx, E_yy, 2 E_xy). About a microsecond.
  Trust at_strain(const Eigen::Vector3d& strain, double energy_density, const Eigen::Vector3d& stress) const;

 private:
  bool in_box(const Eigen::Vector3d& strain, double energy_density) const;
  Trust trust(Quantity quantity, const Eigen::VectorXd& features) const;

  const Model& model_;
  std::vector<double> parameters_;
  double rest_stiffness_ = 1;
  DesignFeatures features_;  ///< where the model has a calibration
};

}  // namespace supple::neural
