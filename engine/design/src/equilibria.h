#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/uniaxial_newton.h"

namespace supple::design {

/// A uniaxial load along a direction of the material.
struct Loading {
  double direction = 0;  ///< rad
  double strain = 0;     ///< Green strain along the direction, > -1/2
  bool operator==(const Loading&) const = default;
};

/// The state under one load: the strain of least energy with the given component along the load [Thesis, eq. 4.9c].
struct Equilibrium : neural::UniaxialPoint {
  Eigen::Vector3d strain = Eigen::Vector3d::Zero();  ///< E_xx, E_yy, 2 E_xy
  /// Derivatives at fixed strain, one column for each parameter; empty if the design has no parameter derivatives.
  Eigen::Matrix3Xd stress_by_parameters;
  bool converged = false;
  double residual = 0;  ///< neural::uniaxial_residual
};

/// The inner problem of inverse design: the equilibria of one design under many loads. Each network evaluation serves
/// all loads whose iteration has not ended. A load is reached from rest, as neural::UniaxialNewton does, or from its
/// equilibrium at nearby parameters.
template <class Real>
class Equilibria {
 public:
  using Evaluator = neural::BasicEvaluator<Real>;

  Equilibria(const Evaluator& evaluator, const std::vector<Loading>& loads, const neural::UniaxialOptions& options);

  /// Sets the token that is checked before each network evaluation. Loads far beyond the training data may take
  /// thousands of evaluations.
  void set_cancellation(const CancellationToken& cancellation) { cancellation_ = cancellation; }

  /// Computes the equilibria from rest. True if all converged.
  bool from_rest(const typename Evaluator::Design& design);
  /// Computes the equilibria from the present states. The present states belong to parameters that were smaller by
  /// `change` and to an orientation that was smaller by `turn`, and must have parameter derivatives. Loads that do not
  /// converge start again from rest. True if all converged.
  bool follow(const typename Evaluator::Design& design, const Eigen::VectorXd& change, double turn = 0);
  /// Sets the angle of the material, relative to its orientation when the loads were given; only before `from_rest`.
  void orient(double orientation);

  std::size_t size() const { return samples_.size(); }
  const Equilibrium& operator[](std::size_t i) const { return samples_[i].state; }
  const Eigen::Vector2d& free_strains(std::size_t i) const { return samples_[i].newton.free_strains(); }
  const neural::UniaxialFrame& frame(std::size_t i) const { return samples_[i].newton.frame(); }

  /// Derivatives of the free strains (E_nn, 2 E_dn) by the parameters, one column for each [Thesis, eq. 4.18].
  Eigen::Matrix2Xd sensitivity(std::size_t i) const;
  /// Derivatives of the free strains by the direction of the load.
  Eigen::Vector2d direction_sensitivity(std::size_t i) const;

  /// Saves the present states, and restores them after other parameters were rejected.
  void save() {
    saved_samples_ = samples_;
    saved_orientation_ = orientation_;
  }
  void restore() {
    samples_ = saved_samples_;
    orientation_ = saved_orientation_;
  }

  /// Number of strains at which the network was evaluated with tangents.
  std::int64_t evaluations() const { return evaluations_; }
  /// Number of times that a load started again from rest because the path from a nearby equilibrium failed.
  std::int64_t restarts() const { return restarts_; }

 private:
  struct Sample {
    neural::UniaxialNewton newton;
    Loading load;
    Equilibrium state;
  };

  static void start_from_rest(Sample& sample, const Equilibrium& rest);
  Equilibrium rest_state(const typename Evaluator::Design& design);
  /// Iterates until no sample needs another evaluation. True if all converged.
  bool run(const typename Evaluator::Design& design);
  void read(Eigen::Index column, Equilibrium& state) const;

  void turn_to(double orientation);

  const Evaluator& evaluator_;
  double orientation_ = 0;
  double saved_orientation_ = 0;
  CancellationToken cancellation_;
  std::vector<Sample> samples_;
  std::vector<Sample> saved_samples_;
  typename Evaluator::Workspace workspace_;
  neural::Evaluation evaluation_;
  Eigen::Matrix3Xd strains_;
  std::int64_t evaluations_ = 0;
  std::int64_t restarts_ = 0;
};

}  // namespace supple::design
