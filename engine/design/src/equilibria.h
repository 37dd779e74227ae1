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
  double strain = 0;     ///< Green strain along it, > -1/2
  bool operator==(const Loading&) const = default;
};

/// One load's state: the strain of least energy with the given component along the load (thesis 4.9c).
struct Equilibrium : neural::UniaxialPoint {
  Eigen::Vector3d strain = Eigen::Vector3d::Zero();  ///< E_xx, E_yy, 2 E_xy
  Eigen::Matrix3Xd stress_by_parameters;  ///< at fixed strain, a column for each; empty where the design has none
  bool converged = false;
  double residual = 0;  ///< neural::uniaxial_residual
};

/// The inner problem of inverse design: equilibria of one design under many loads at once, each network evaluation of
/// all loads that are still at work together. A load is reached from rest as neural::UniaxialNewton does, or from its
/// equilibrium at nearby parameters.
template <class Real>
class Equilibria {
 public:
  using Evaluator = neural::BasicEvaluator<Real>;

  Equilibria(const Evaluator& evaluator, const std::vector<Loading>& loads, const neural::UniaxialOptions& options);

  /// From now on every round of network evaluations looks for a stop request: loads far beyond what the model knows may
  /// take thousands.
  void stop_on(const CancellationToken& cancellation) { cancellation_ = cancellation; }

  /// From rest. True if all converged.
  bool from_rest(const typename Evaluator::Design& design);
  /// From the present states, which are those of parameters `change` and of an orientation `turn` earlier; loads that
  /// do not converge so go from rest. The present states' designs must have had parameter derivatives. True if all
  /// converged.
  bool follow(const typename Evaluator::Design& design, const Eigen::VectorXd& change, double turn = 0);
  /// Turns the material by an angle from where it was when the loads were given; only before `from_rest`.
  void orient(double orientation);

  std::size_t size() const { return samples_.size(); }
  const Equilibrium& operator[](std::size_t i) const { return samples_[i].state; }
  const Eigen::Vector2d& free_strains(std::size_t i) const { return samples_[i].newton.free_strains(); }
  const neural::UniaxialFrame& frame(std::size_t i) const { return samples_[i].newton.frame(); }

  /// How the free strains (E_nn, 2 E_dn) follow the parameters, a column for each; thesis 4.18.
  Eigen::Matrix2Xd sensitivity(std::size_t i) const;
  /// How they follow the direction of the load.
  Eigen::Vector2d direction_sensitivity(std::size_t i) const;

  /// Remembers the present states, and goes back to them after other parameters were tried in vain.
  void keep() {
    kept_ = samples_;
    kept_orientation_ = orientation_;
  }
  void go_back() {
    samples_ = kept_;
    orientation_ = kept_orientation_;
  }

  /// Strains that the network was evaluated at so far, with tangents.
  std::int64_t evaluations() const { return evaluations_; }
  /// Loads that had to be followed from rest though a nearby state was known.
  std::int64_t restarts() const { return restarts_; }

 private:
  struct Sample {
    neural::UniaxialNewton newton;
    Loading load;
    Equilibrium state;
  };

  static void start_from_rest(Sample& sample, const Equilibrium& rest);
  Equilibrium rest_state(const typename Evaluator::Design& design);
  /// Works on all samples that are at work until none is. True if all converged.
  bool run(const typename Evaluator::Design& design);
  void read(Eigen::Index column, Equilibrium& state) const;

  void turn_to(double orientation);

  const Evaluator& evaluator_;
  double orientation_ = 0;
  double kept_orientation_ = 0;
  CancellationToken cancellation_;
  std::vector<Sample> samples_;
  std::vector<Sample> kept_;
  typename Evaluator::Workspace workspace_;
  neural::Evaluation evaluation_;
  Eigen::Matrix3Xd strains_;
  std::int64_t evaluations_ = 0;
  std::int64_t restarts_ = 0;
};

}  // namespace supple::design
