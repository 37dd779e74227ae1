#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// The weights of the terms of the energy; a term of weight 0 is left out and costs nothing. Lengths count in units of
/// the mean cell size, root of area over sites, so that every term is a number without a unit.
struct ObjectiveWeights {
  double edge_length = 0;  ///< (1/2) sum over Voronoi edges of (g(x_i, x_j) - L)^2 (thesis eq. 3.29)
  double planarity = 0;  ///< (1/2) sum over cells of the mean squared distance of their corners from a plane (eq. 3.30)
  double regularity = 0;  ///< (1/2) sum over cells and their vertices of g(s_i, x_j)^2 (eq. 3.31)
  double centroidal = 0;  ///< (1/2) sum over cells of the integral of g(s_i, x)^2: centroidal cells
  double equal_area = 0;  ///< (1/2) sum over cells of (A_i - mean)^2
};

enum class OptimizationMethod {
  automatic,     ///< gauss_newton where areas are all that counts, otherwise lbfgs
  gauss_newton,  ///< exact gradients, Gauss-Newton Hessians, one sparse factorization an iteration
  lbfgs
};

/// One state on the way.
struct OptimizationStep {
  double energy = 0;
  double gradient_norm = 0;
  double step_length = 0;  ///< root of the sum of the sites' squared ways; 0 for the start
};

/// Iterations beyond this are refused. Optimizations take dozens to hundreds.
inline constexpr int most_optimization_iterations = 10'000;

/// A pass of moves of single sites that lowers the energy by at most this fraction of it is the last one.
inline constexpr double smallest_gain_of_a_pass = 1e-3;

/// Passes of moves of single sites beyond this are not made, and the search ends as at its limit of iterations.
inline constexpr int max_site_move_passes = 10;

struct OptimizationOptions {
  ObjectiveWeights weights;
  OptimizationMethod method = OptimizationMethod::automatic;
  /// Of eq. 3.29, mesh units; 0 for the mean length of the start.
  double edge_length = 0;
  /// Converged once |grad E| <= tolerance * sqrt(sites) / (mean cell size).
  double tolerance = 1e-6;
  double border_deviation = DiagramOptions{}.border_deviation;  ///< as in DiagramOptions
  int max_iterations = 100;                                     ///< at most most_optimization_iterations
  /// Sites that stay where they are.
  std::vector<std::int32_t> fixed_sites;
  /// Called with the start and the state after every iteration, on the thread of the caller.
  std::function<void(const OptimizationStep& step, const Diagram& diagram)> observer{};
};

/// What is tried where no step for all sites lowers the energy.
struct SiteMoveTrials {
  int held_searches = 0;   ///< how often this was so: steps then went on without the sites of far the largest gradients
  int passes = 0;          ///< over all free sites, each moved in 8 directions by 5 lengths, 0.3 to 1e-3 cell sizes
  std::int64_t tried = 0;  ///< moves of single sites whose energy was computed
  std::int64_t taken = 0;  ///< moves that lowered the energy, and were kept
  double energy_before = 0;  ///< where no step for all sites lowered it for the first time
  double last_gain = 0;      ///< fraction of the energy by which the last pass lowered it
};

struct Optimization {
  Diagram diagram;  ///< at the end
  struct Term {
    std::string name;   ///< "edge_length", "planarity", "regularity", "centroidal" or "equal_area"
    double energy = 0;  ///< times its weight
  };
  std::vector<Term> terms;  ///< that took part
  double energy = 0;
  double gradient_norm = 0;
  double gradient_tolerance = 0;
  int iterations = 0;
  std::vector<OptimizationStep> history;
  /// "converged": the gradient is within its tolerance; "step_too_small": neither a step nor a pass of moves of single
  /// sites lowers the energy by more than smallest_gain_of_a_pass of it; "iteration_limit".
  std::string stopped;
  SiteMoveTrials site_moves;  ///< all 0 where steps for all sites sufficed
  DiagramStatistics before;
  DiagramStatistics after;
};

/// Moves the sites to a local minimum of the energy. The diagram is made anew at every state that is tried, so that
/// cells change their neighbours freely, where most sites are held only round those that move (MovingDiagram); it never
/// rises in energy from one iteration to the next. Where no step for all sites lowers the energy, which has kinks and
/// jumps, the few sites next to one, whose gradients are far above the others', are held, and steps go on without them.
/// Where this gains little, single sites are moved by themselves (SiteMoveTrials). Then steps for all sites go on. All
/// that is tried between two of these counts as one iteration; a pass of moves of single sites takes some hundred
/// diagrams, of which only the surroundings of moved sites are made anew where sites are few.
///
/// Bills "propagation", "cells", "derivatives", "step", one effect for each term, and the quantity "site_moves". Throws
/// what `diagram` throws, "voronoi.no_objective" (all weights 0), "voronoi.invalid_option" (weights, tolerance,
/// border_deviation, max_iterations, edge_length), "voronoi.fixed_site".
Optimization optimize(const surface::GeodesicSolver& solver, std::vector<surface::SurfacePoint> sites,
                      const OptimizationOptions& options, const Execution& execution = {});

}  // namespace supple::voronoi
