#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// Weights of the terms of the energy. A term of weight 0 is left out and costs nothing. Lengths are measured in units
/// of the mean cell size, sqrt(area / sites), so that every term is dimensionless. x: Voronoi vertices, s: sites, g:
/// geodesic distance, A: areas of cells, L: target length.
struct ObjectiveWeights {
  double edge_length = 0;  ///< (1/2) sum over Voronoi edges of (g(x_i, x_j) - L)^2 [Thesis, eq. 3.29]
  double planarity = 0;  ///< (1/2) sum over cells of the corners' mean squared distance from a plane [Thesis, eq. 3.30]
  double regularity = 0;  ///< (1/2) sum over cells and their vertices of g(s_i, x_j)^2 [Thesis, eq. 3.31]
  double centroidal = 0;  ///< (1/2) sum over cells of the integral of g(s_i, x)^2: centroidal cells
  double equal_area = 0;  ///< (1/2) sum over cells of (A_i - mean)^2
};

enum class OptimizationMethod {
  automatic,     ///< gauss_newton if equal_area is the only objective, otherwise lbfgs
  gauss_newton,  ///< exact gradients, Gauss-Newton Hessians, one sparse factorization per iteration
  lbfgs
};

/// Why an optimization ended.
enum class OptimizationTermination {
  converged,  ///< the gradient norm is within its tolerance
  /// Neither a step for all sites nor a pass of single-site moves lowers the energy by more than the fraction
  /// min_pass_gain.
  step_too_small,
  iteration_limit,  ///< max_iterations or max_site_move_passes was reached
  deadline,         ///< the deadline passed; the result is the last state of the history
  memory            ///< a limit of memory was reached; the result is the last state of the history
};
/// "converged", "step_too_small", "iteration_limit", "deadline" or "memory".
std::string_view to_string(OptimizationTermination termination);

/// One entry of the iteration history.
struct OptimizationStep {
  double energy = 0;
  double gradient_norm = 0;
  double step_length = 0;  ///< root of the sum of the sites' squared displacements, mesh units; 0 at the start
};

/// Maximum of max_iterations; larger values are refused. Optimizations take dozens to hundreds.
inline constexpr int max_optimization_iterations = 10'000;

/// A pass of single-site moves that lowers the energy by at most this fraction is the last one.
inline constexpr double min_pass_gain = 1e-3;

/// Maximum number of passes of single-site moves. Beyond it the search ends with "iteration_limit".
inline constexpr int max_site_move_passes = 10;

struct OptimizationOptions {
  ObjectiveWeights weights;
  OptimizationMethod method = OptimizationMethod::automatic;
  /// Target length L of [Thesis, eq. 3.29], mesh units; 0 for the mean length at the start.
  double edge_length = 0;
  /// The optimization has converged once |grad E| <= tolerance * sqrt(sites) / (mean cell size).
  double tolerance = 1e-6;
  double border_deviation = DiagramOptions{}.border_deviation;  ///< see DiagramOptions
  int max_iterations = 100;                                     ///< at most max_optimization_iterations
  /// Sites that do not move.
  std::vector<std::int32_t> fixed_sites;
  /// Called with the state at the start and after every iteration, on the caller's thread.
  std::function<void(const OptimizationStep& step, const Diagram& diagram)> observer{};
};

/// Statistics of the searches that follow when a step for all sites fails to lower the energy.
struct SiteMoveTrials {
  /// Number of such failures. After each of them, the sites of far the largest gradients are fixed for some iterations.
  int held_searches = 0;
  /// Passes over all free sites. Each site is moved in 8 directions by 5 lengths, 0.3 to 1e-3 mean cell sizes.
  int passes = 0;
  std::int64_t tried = 0;    ///< single-site moves whose energy was computed
  std::int64_t taken = 0;    ///< single-site moves that lowered the energy and were accepted
  double energy_before = 0;  ///< energy at the first of these failures
  double last_gain = 0;      ///< fraction by which the last pass lowered the energy
};

struct Optimization {
  Diagram diagram;  ///< diagram of the optimized sites
  struct Term {
    std::string name;   ///< "edge_length", "planarity", "regularity", "centroidal" or "equal_area"
    double energy = 0;  ///< weighted
  };
  std::vector<Term> terms;  ///< the terms of nonzero weight
  double energy = 0;
  double gradient_norm = 0;
  double gradient_tolerance = 0;
  int iterations = 0;
  std::vector<OptimizationStep> history;
  OptimizationTermination stopped = OptimizationTermination::converged;
  SiteMoveTrials site_moves;  ///< all 0 if steps for all sites sufficed
  DiagramStatistics before;
  DiagramStatistics after;
};

/// Moves the sites to a local minimum of the energy, which never rises from one iteration to the next. The diagram is
/// computed anew at every trial state, so that cells change their neighbours freely. If most sites are fixed, only the
/// faces around the moving ones are recomputed (MovingDiagram).
///
/// The energy has kinks and jumps, next to which no step for all sites may lower it. Then the few sites whose gradients
/// are far above the others' are fixed temporarily, and steps go on for the others. If this gains little, a pass moves
/// single sites by themselves (SiteMoveTrials). Then steps for all sites go on. Everything between two sequences of
/// steps for all sites counts as one iteration. A pass costs a few hundred diagrams, of which those that move few sites
/// are only recomputed around them.
///
/// If a stop is requested for a deadline or a limit of memory (StopReason), or memory is refused, after the first state
/// was evaluated, the result is the best state so far, which is the last one of the history. A warning of the diagram
/// says so. The stop is taken back for the report, which measures the lengths of the Voronoi edges.
///
/// Bills "propagation", "cells", "derivatives", "step", one effect for each term, and the quantity "site_moves". Throws
/// what `diagram` throws, "voronoi.no_objective" (all weights 0), "voronoi.invalid_option" (weights, tolerance,
/// border_deviation, max_iterations, edge_length), "voronoi.fixed_site".
Optimization optimize(const surface::GeodesicSolver& solver, std::vector<surface::SurfacePoint> sites,
                      const OptimizationOptions& options, const Execution& execution = {});

}  // namespace supple::voronoi
