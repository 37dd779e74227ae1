#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::surface {

enum class MinimizationMethod { newton, lbfgs, gradient_descent };

struct KarcherProblem {
  std::vector<SurfacePoint> points;  ///< at least one
  std::vector<double> weights;       ///< nonnegative, not all zero; empty for equal weights
  MinimizationMethod method = MinimizationMethod::newton;
  /// The search has converged when |grad E| <= tolerance * mesh diagonal. E has the unit of a squared length, and its
  /// gradient that of a length.
  double tolerance = 1e-9;
  int max_iterations = 200;
  /// The point where the search starts. Without it, the search starts from the given point with the smallest objective.
  /// If more than five points are given, only the five nearest in space to the weighted centroid are considered.
  std::optional<SurfacePoint> start;
  /// The number of searches, at least one. Each search after the first begins at a vertex that is far in space from all
  /// previous starts and minima, and costs as much as the first. The lowest minimum is the answer.
  int starts = 1;
  /// "on" stores a distance field for each point, and "off" searches for pairs. "automatic" chooses the cheaper one,
  /// according to the size of the mesh and the number of points.
  enum class KeptFields { automatic, on, off } kept_fields = KeptFields::automatic;
};

struct KarcherStep {
  double objective = 0;
  double gradient_norm = 0;   ///< |grad E| in mesh units; at a vertex, the magnitude of the steepest negative slope
  double step_length = 0;     ///< length moved on the surface to reach this state; 0 for the start
  double regularization = 0;  ///< added to the Hessian's diagonal
};

/// Why the search for a mean ended.
enum class KarcherTermination {
  converged,
  /// A minimum at a saddle or boundary vertex where E has no derivative: no direction descends, and the gradient norm,
  /// there the slope of steepest descent, is 0.
  kink,
  step_too_small,
  iteration_limit
};
/// "converged", "kink", "step_too_small" or "iteration_limit".
std::string_view to_string(KarcherTermination termination);

struct KarcherMean {
  SurfacePoint mean;
  Eigen::Vector3d position;
  /// E = sum w_i g_i^2 / (2 sum w_i), weighted [Thesis, eq. 3.16]. Mesh units squared.
  double objective = 0;
  double gradient_norm = 0;
  int iterations = 0;                ///< iterations of the search that found this mean
  std::vector<KarcherStep> history;  ///< the start of that search and every iteration
  int start = 0;                     ///< the number of that search, counted from 0
  KarcherTermination stopped = KarcherTermination::converged;
};

/// Finds the point of least weighted mean squared geodesic distance. It is a local minimum. The problem may have
/// several minima, and `starts` searches for a lower one. Bills the effects "kept_fields", "guided_searches" and
/// "multi_start".
///
/// Throws "karcher.no_points", "karcher.weights" (count, sign, sum, non-finite), "karcher.invalid_option" (tolerance,
/// iterations, starts), "karcher.unreachable" (points on different components, each named), "point.*".
KarcherMean karcher_mean(const GeodesicSolver& solver, const KarcherProblem& problem, const Execution& execution = {});

}  // namespace supple::surface
