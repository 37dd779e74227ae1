#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "supple/numerics/objective.h"

namespace supple::numerics {

/// How far analytic derivatives are from finite differences, and where they are worst.
///
/// The error of an entry is |analytic - numeric| / (largest analytic entry of the same array), so that nothing is
/// divided by an entry that vanishes. An array of zeros is measured absolutely.
struct DerivativeCheck {
  struct Worst {
    double error = 0;
    Eigen::Index row = 0;
    Eigen::Index column = 0;  ///< 0 for the gradient
    double analytic = 0;
    double numeric = 0;
    /// The extrapolation's own estimate of the error of the numeric entry, in the same measure. An error below it means
    /// nothing.
    double uncertainty = 0;
  };
  Worst gradient;
  Worst hessian;  ///< empty (error 0) only where the options leave Hessians out

  /// One sentence with both worst entries.
  std::string summary() const;
};

struct DerivativeCheckOptions {
  /// The length of the longest finite-difference step. It is halved `levels - 1` times. Of all extrapolated differences
  /// the one is used that shorter steps change least (Ridders 1982). Choose a length well inside the smooth region.
  double step = 1e-2;
  int levels = 8;
  bool hessian = true;
  /// The gradients at displaced states are given in frames that have turned along with the state (a chart that is
  /// rebased), with no transport back. Differences of such gradients are the Hessian plus an antisymmetric matrix, the
  /// frames' torsion times the gradient: straight lines do not feel it, and only the symmetric part is compared.
  bool frames_turn = false;
};

/// A function near a base state: value and derivatives at the state that lies `step` away, with the gradient expressed
/// in the frame of the base state. Only the base state (a zero step) is asked for the Hessian.
using LocalFunction = std::function<Evaluation(const Eigen::VectorXd& step, int order)>;

/// Compares the gradient with central differences of the value, and the Hessian with central differences of the
/// gradient. Takes 2 levels n evaluations of order 1. Checks every kind of Hessian, including bordered ones. Throws
/// std::invalid_argument if the function gives no gradient of n entries, or no n x n Hessian although the options ask
/// for one, because what was not checked must not pass.
DerivativeCheck check_derivatives(const LocalFunction& function, Eigen::Index dimension,
                                  const DerivativeCheckOptions& options = {});

/// The same for an objective on a manifold at its current state, along its retraction and with its transport.
DerivativeCheck check_derivatives(Objective& objective, const DerivativeCheckOptions& options = {});

}  // namespace supple::numerics
