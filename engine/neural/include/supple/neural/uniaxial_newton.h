#pragma once

#include <Eigen/Core>

#include "supple/neural/uniaxial_frame.h"

namespace supple::neural {

/// Energy density, stress and tangent at a strain, all in MPa.
struct UniaxialPoint {
  double energy_density = 0;
  Eigen::Vector3d stress = Eigen::Vector3d::Zero();
  Eigen::Matrix3d tangent = Eigen::Matrix3d::Zero();
  bool finite() const;
};

struct UniaxialOptions {
  /// A state has converged if |(n^T S n, d^T S n)| <= tolerance * max(|S|, |C| / 1000). n is orthogonal to d. S is the
  /// vector of the stress's three components, and C the 3 x 3 matrix of the tangent. Norms are Frobenius norms.
  double tolerance = 1e-10;
  int max_iterations = 50;  ///< limit of the Newton iterations in one increment of the load
  int max_halvings = 40;    ///< limit of the halvings of one Newton step
};

/// The search for equilibria under one uniaxial load. It does not evaluate the energy itself. The caller evaluates it
/// at `trial` and passes the result to `receive`, which allows evaluations for many loads at a time. The search is
/// Newton's method for the two free components of strain, with a positive definite model and a line search. This is
/// sequential quadratic programming in the null space of the constraint of [Thesis, eq. 4.9c]. A given strain is
/// reached in increments of at most 0.1, which are predicted along the tangent of the path, so that the search follows
/// the branch that goes through rest.
class UniaxialNewton {
 public:
  explicit UniaxialNewton(const UniaxialFrame& frame, const UniaxialOptions& options = {});

  /// Sets the state to rest. `rest` is the evaluation there.
  void start_from_rest(const UniaxialPoint& rest);
  /// Starts the search for the equilibrium at a given strain, from the current state.
  void go_to(double axial_strain);
  /// Changes the direction of the load. The free strains keep their values. `start_in_one_increment` must be called
  /// next.
  void turn(const UniaxialFrame& frame) { frame_ = frame; }
  /// Starts the search for the equilibrium at a given strain in one increment. The free strains first change by `step`,
  /// which is shortened to the limit of a step. This suits an energy that has changed a little.
  void start_in_one_increment(double axial_strain, const Eigen::Vector2d& step);

  /// Whether the search has not ended.
  bool working() const { return phase_ == Phase::predicting || phase_ == Phase::searching; }
  bool converged() const { return phase_ == Phase::done; }
  /// The strain at which the energy has to be evaluated next, while `working()`.
  Eigen::Vector3d trial() const { return frame_.strain(trial_axial_strain_, trial_free_strains_); }
  /// Takes the evaluation at `trial()`. Returns true if the trial was accepted as the current state. Otherwise a
  /// shorter step is tried next, or the search has failed.
  bool receive(const UniaxialPoint& trial);

  const UniaxialFrame& frame() const { return frame_; }
  const UniaxialPoint& point() const { return point_; }
  Eigen::Vector3d strain() const { return frame_.strain(axial_strain_, free_strains_); }
  const Eigen::Vector2d& free_strains() const { return free_strains_; }  ///< E_nn, 2 E_dn
  double residual() const { return residual_; }                          ///< uniaxial_residual at `point`
  int iterations() const { return iterations_; }  ///< Newton iterations since the search for the given strain began

 private:
  enum class Phase { done, failed, predicting, searching };

  /// Whether the trial decreases the energy sufficiently, or, if energies differ by rounding only, halves the gradient.
  bool accepts(const UniaxialPoint& trial) const;
  /// Sets the trial of the next increment, along the path's tangent.
  void predict();
  /// Sets the trial of the next Newton step, or starts the next increment, or ends the search.
  void correct();
  Eigen::Matrix2d free_tangent() const { return frame_.free.transpose() * point_.tangent * frame_.free; }

  UniaxialFrame frame_;
  UniaxialOptions options_;
  UniaxialPoint point_;
  Eigen::Vector2d free_strains_ = Eigen::Vector2d::Zero();  ///< E_nn, 2 E_dn
  Eigen::Vector2d trial_free_strains_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d step_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d gradient_ = Eigen::Vector2d::Zero();
  double axial_strain_ = 0;  ///< E_dd
  double trial_axial_strain_ = 0;
  double target_axial_strain_ = 0;
  double residual_ = 0;
  int iterations_ = 0;
  int increment_iterations_ = 0;  ///< Newton iterations in the current increment
  int remaining_increments_ = 0;  ///< number of increments after the current one
  int halvings_ = 0;
  Phase phase_ = Phase::done;
};

}  // namespace supple::neural
