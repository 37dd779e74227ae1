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
  /// A state has converged once |(n^T S n, d^T S n)| <= tolerance * max(|S|, |C| / 1000): n orthogonal to d, S and C
  /// stress and tangent as three components and their matrix, their Frobenius norms.
  double tolerance = 1e-10;
  int max_iterations = 50;  ///< Newton iterations after one increment of the load
  int max_halvings = 40;    ///< how often one Newton step is halved at most
};

/// The search for equilibria under one uniaxial load. It does not evaluate the energy itself: the caller evaluates it
/// at `trial` and hands in the result, for one load or for many loads at a time. The search is Newton's method on the
/// two free components of strain, with a positive definite model and a line search (sequential quadratic programming in
/// the null space of the constraint; thesis 4.9c and 4.15 to 4.18). A given strain is reached in increments of at most
/// 0.1 along the tangent of the path, so that the search follows the branch that goes through rest.
class UniaxialNewton {
 public:
  explicit UniaxialNewton(const UniaxialFrame& frame, const UniaxialOptions& options = {});

  /// Begins at rest, where energy and stress are those of `rest`.
  void start_from_rest(const UniaxialPoint& rest);
  /// Begins the way from the present state to a given strain.
  void go_to(double given);
  /// Takes another direction of the load. The free strains stay as they are, to be gone on from by `go_straight_to`.
  void turn(const UniaxialFrame& frame) { frame_ = frame; }
  /// Goes to a given strain in one increment, with free strains that change by `step` (as far as one step may go). This
  /// suits an energy that has changed a little.
  void go_straight_to(double given, const Eigen::Vector2d& step);

  bool working() const { return phase_ == Phase::predicting || phase_ == Phase::searching; }
  bool converged() const { return phase_ == Phase::done; }
  /// The strain at which the energy has to be evaluated next, while `working()`.
  Eigen::Vector3d trial() const { return frame_.strain(trial_given_, trial_x_); }
  /// Takes the evaluation at `trial()`. Returns true if the search has moved there. Otherwise a shorter step is tried
  /// next, or the search has ended.
  bool receive(const UniaxialPoint& trial);

  const UniaxialFrame& frame() const { return frame_; }
  const UniaxialPoint& point() const { return point_; }
  Eigen::Vector3d strain() const { return frame_.strain(given_, x_); }
  const Eigen::Vector2d& free_strains() const { return x_; }  ///< E_nn, 2 E_dn
  double residual() const { return residual_; }               ///< uniaxial_residual at `point`
  int iterations() const { return iterations_; }              ///< Newton iterations since the present way began

 private:
  enum class Phase { done, failed, predicting, searching };

  bool accepts(const UniaxialPoint& trial) const;
  void predict();
  void correct();
  Eigen::Matrix2d free_tangent() const { return frame_.free.transpose() * point_.tangent * frame_.free; }

  UniaxialFrame frame_;
  UniaxialOptions options_;
  UniaxialPoint point_;
  Eigen::Vector2d x_ = Eigen::Vector2d::Zero();  ///< E_nn, 2 E_dn
  Eigen::Vector2d trial_x_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d step_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d gradient_ = Eigen::Vector2d::Zero();
  double given_ = 0;  ///< E_dd
  double trial_given_ = 0;
  double target_ = 0;
  double residual_ = 0;
  int iterations_ = 0;
  int iterations_here_ = 0;  ///< after this increment
  int increments_left_ = 0;  ///< after this one
  int halvings_ = 0;
  Phase phase_ = Phase::done;
};

}  // namespace supple::neural
