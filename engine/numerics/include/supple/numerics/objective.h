#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <limits>
#include <memory>
#include <optional>
#include <variant>

namespace supple::numerics {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// The symmetric matrix [core border; border^T corner] + low_rank low_rank^T. This is a sparse matrix with a few dense
/// rows and columns at its end, plus a few dense products.
struct BorderedMatrix {
  SparseMatrix core;         ///< n x n, the lower triangle only
  Eigen::MatrixXd border;    ///< n x m
  Eigen::MatrixXd corner;    ///< m x m, both triangles; m is small and may be 0
  Eigen::MatrixXd low_rank;  ///< (n + m) x k; k is small, and empty stands for 0
};

/// A symmetric matrix of second derivatives: none, dense or sparse with both triangles filled, or bordered. A bordered
/// one is shared with the objective and valid until its next evaluation of order 2.
using Hessian = std::variant<std::monostate, Eigen::MatrixXd, SparseMatrix, std::shared_ptr<const BorderedMatrix>>;

/// A function's value and derivatives at one state. Entries above the order that was asked for are empty.
struct Evaluation {
  double value = 0;
  Eigen::VectorXd gradient;
  Hessian hessian;
};

/// A function on a manifold with a state that can be moved. The minimizer minimizes such a function.
///
/// There is a current state and, between `move` and `accept` or `reject`, a trial state. Tangent vectors have
/// `dimension()` coordinates in an orthonormal frame that belongs to the state; in a vector space the frame is always
/// the same and `transport` has nothing to do. The frame of the trial state may be chosen by `evaluate`, so `transport`
/// is called after it.
class Objective {
 public:
  virtual ~Objective() = default;

  virtual Eigen::Index dimension() const = 0;

  /// Value (order 0), gradient (1) and Hessian (2) at the trial state if there is one, otherwise at the current state.
  /// A value that is not finite marks a trial state as invalid. The minimizer first asks for the value at a trial state
  /// and, if it accepts the state, for the derivatives. An objective whose value costs nearly as much as its
  /// derivatives should keep what it has computed.
  virtual Evaluation evaluate(int order) = 0;

  /// Makes the trial state: the current one moved along `step` by the retraction of the manifold. Returns the part of
  /// `step` that was travelled: all of it unless something (a boundary) stopped parts of the motion.
  virtual Eigen::VectorXd move(const Eigen::VectorXd& step) = 0;

  virtual void accept() = 0;  ///< the trial state becomes the current one
  virtual void reject() = 0;  ///< the trial state is forgotten

  /// A positive semidefinite matrix near the Hessian at the current state, after this was evaluated, if the objective
  /// knows one. Newton's method uses it if the Hessian itself is not positive definite.
  virtual std::optional<Hessian> convex_hessian() { return std::nullopt; }

  /// The largest t > 0 such that t * step keeps the state valid (no inverted element, no contact passed through).
  virtual double largest_step(const Eigen::VectorXd& /*step*/) const { return std::numeric_limits<double>::infinity(); }

  /// Carries a tangent vector of the current state to the trial state, by an isometry. Returns false if no transport
  /// makes sense (across a kink). What was learned about the curvature is then forgotten.
  virtual bool transport(Eigen::VectorXd& /*tangent*/) const { return true; }

  /// Called when a step had to be shortened, which is a sign of a place nearby where the function is not
  /// differentiable. An objective that knows such places may replace the trial state (or make one, if there is none) by
  /// one of them whose value is lower than those of the current and the trial state. It then returns the distance of
  /// that state from the current one.
  virtual std::optional<double> try_nonsmooth_candidates() { return std::nullopt; }
};

}  // namespace supple::numerics
