#pragma once

#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::surface {

enum class MinimizationMethod { newton, lbfgs, gradient_descent };

struct KarcherProblem {
  std::vector<SurfacePoint> points;  ///< at least one
  std::vector<double> weights;       ///< nonnegative, not all zero; empty for equal weights
  MinimizationMethod method = MinimizationMethod::newton;
  /// Stops once |grad E| <= tolerance * mesh diagonal: E has the unit of a squared length, its gradient of a length.
  double tolerance = 1e-9;
  int max_iterations = 200;
  /// Without it: the given point of smallest objective; of more than five, among the five nearest in space to the
  /// weighted centroid.
  std::optional<SurfacePoint> start;
  /// Searches that are made, at least one: those after the first begin at vertices far in space from all starts and
  /// minima before, and the lowest minimum is the answer. Each costs as much as the first.
  int starts = 1;
  /// Whether a kept distance field per point is used ("on"), pair searches ("off"), or the cheaper by the mesh's size
  /// and the number of points ("automatic").
  enum class KeptFields { automatic, on, off } kept_fields = KeptFields::automatic;
};

struct KarcherStep {
  double objective = 0;
  double gradient_norm = 0;   ///< |grad E|; at a vertex the slope of steepest descent. Mesh units.
  double step_length = 0;     ///< length moved on the surface to reach this state; 0 for the start
  double regularization = 0;  ///< added to the Hessian's diagonal
};

struct KarcherMean {
  SurfacePoint mean;
  Eigen::Vector3d position;
  /// E = sum w_i g_i^2 / (2 sum w_i) (thesis eq. 3.16, weighted). Mesh units squared.
  double objective = 0;
  double gradient_norm = 0;
  int iterations = 0;                ///< of the search that led here
  std::vector<KarcherStep> history;  ///< its start and every iteration
  int start = 0;                     ///< which of the searches that is, from 0
  /// "converged"; "kink" (a minimum at a saddle or boundary vertex where E has no derivative: no direction descends,
  /// and gradient_norm, there the slope of steepest descent, is 0); "step_too_small"; or "iteration_limit".
  std::string stopped;
};

/// The point of least weighted mean squared geodesic distance. A local minimum: the problem may have several, among
/// which `starts` looks for a lower one. Bills the effects "kept_fields", "guided_searches" and "multi_start".
/// Throws "karcher.no_points", "karcher.weights" (count, sign, sum, non-finite), "karcher.invalid_option"
/// (tolerance, iterations, starts), "karcher.unreachable" (points on different components, each named), "point.*".
KarcherMean karcher_mean(const GeodesicSolver& solver, const KarcherProblem& problem, const Execution& execution = {});

}  // namespace supple::surface
