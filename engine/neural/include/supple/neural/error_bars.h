#pragma once

#include <optional>
#include <span>
#include <vector>

#include "supple/neural/error_features.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/model.h"

namespace supple::neural {

/// The trust in a result of a model.
struct Trust {
  /// Whether the state is within the ranges of training (neural::in_range) and its error bar, if the model has error
  /// bars, is at most max_trusted_error.
  bool in_range = false;
  /// The error bar, as in Quantity. None if the model has no calibration, or if the state is outside of the ranges of
  /// training, where there were no simulations to calibrate with.
  std::optional<double> error;
};

/// The error bars of one design of a model. The model must outlive it. Several threads may use it at once.
class ErrorBars {
 public:
  /// `with_uniaxial` prepares it for `uniaxial`. This takes one evaluation with the tangent if the model has a
  /// calibration. `origin` says how the design was chosen, because a search prefers designs with large errors.
  ErrorBars(const Model& model, const Evaluator& evaluator, const Evaluator::Design& design,
            std::span<const double> parameters, bool with_uniaxial, Origin origin = Origin::given);

  /// The error bar of a quantity at a uniaxial equilibrium. `axial_strain` is d^T E d, `strain` the whole strain there,
  /// and `point` the network's evaluation. `quantity` must not be stress_at_strain. Takes about 2 microseconds.
  Trust uniaxial(Quantity quantity, const UniaxialFrame& frame, double axial_strain, const Eigen::Vector3d& strain,
                 const UniaxialPoint& point) const;

  /// The error bar of the stress at a strain (E_xx, E_yy, 2 E_xy). Takes about a microsecond.
  Trust at_strain(const Eigen::Vector3d& strain, double energy_density, const Eigen::Vector3d& stress) const;

 private:
  /// Whether the design and the strain are within the ranges of training.
  bool in_box(const Eigen::Vector3d& strain, double energy_density) const;
  Trust trust(Quantity quantity, const Eigen::VectorXd& features) const;

  const Model& model_;
  std::vector<double> parameters_;
  Origin origin_;
  double rest_stiffness_ = 1;
  DesignFeatures features_;  ///< set only if the model has a calibration
};

}  // namespace supple::neural
