#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "supple/numerics/objective.h"

namespace supple::numerics {

/// The largest differences between analytic derivatives and finite differences.
///
/// The error of an entry is |analytic - numeric| / (largest analytic entry of the same array), so that nothing is
/// divided by an entry that vanishes. For an array of zeros the error is absolute.
struct DerivativeCheck {
  struct Worst {
    double error = 0;
    Eigen::Index row = 0;
    Eigen::Index column = 0;  ///< 0 for the gradient
    double analytic = 0;
    double numeric = 0;
    /// The error of the numeric entry as the extrapolation estimates it, in the same measure. A smaller `error` means
    /// nothing.
    double uncertainty = 0;
  };
  Worst gradient;
  Worst hessian;  ///< empty (error 0) only where the options leave Hessians out

  /// A sentence about the entries with the largest errors.
  std::string summary() const;
};

struct DerivativeCheckOptions {
  /// Length of the longest finite-difference step, which is halved `levels - 1` times. Among all extrapolated
  /// differences, the one is used that shorter steps change least [Ridders1982]. The length should be well inside the
  /// region where the function is smooth.
  double step = 1e-2;
  int levels = 8;
  bool hessian = true;
  /// Whether gradients at displaced states are written in frames that have turned with the state (a chart that is
  /// rebased), without transport back. Differences of such gradients are the Hessian plus an antisymmetric matrix: the
  /// frames' torsion times the gradient. Only the symmetric part is then compared.
  bool frames_turn = false;
};

/// A function near a base state. It returns the value and derivatives at the state that lies `step` away, with the
/// gradient written in the frame of the base state. The Hessian is asked for at the base state only (a zero step).
using LocalFunction = std::function<Evaluation(const Eigen::VectorXd& step, int order)>;

/// Compares the gradient with central differences of the value, and the Hessian with central differences of the
/// gradient. Takes 2 levels n evaluations of order 1. Works for every kind of Hessian, including bordered ones.
///
/// Throws std::invalid_argument if the function returns no gradient of n entries, or no n x n Hessian although the
/// options ask for one: a derivative that is missing must not pass.
DerivativeCheck check_derivatives(const LocalFunction& function, Eigen::Index dimension,
                                  const DerivativeCheckOptions& options = {});

/// The same for an objective on a manifold at its current state, along its retraction and with its transport.
DerivativeCheck check_derivatives(Objective& objective, const DerivativeCheckOptions& options = {});

}  // namespace supple::numerics
