#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "design_bench.h"
#include "outer_solvers.h"
#include "target_residuals.h"

namespace supple::bench {

/// |r| reaches the least that any solver found if it is larger by this share and this margin at most,
inline constexpr double reached_share = 1e-6;
inline constexpr double reached_margin = 1e-7;
/// and comes close if it is larger by this at most: further starts of the service stop there too.
inline constexpr double close_margin = 1e-3;

/// The outer problem for one target.
struct OuterProblem {
  std::vector<design::SampledTarget> targets;  ///< one
  Eigen::VectorXd start;                       ///< in the unit box

  design::TargetResiduals residuals(const LoadedSpace& space) const;
};

/// The target is the profile of a random design, perturbed by waves of about a seventh of its size that no design
/// follows. The start is random, and has equilibria.
OuterProblem draw_problem(const LoadedSpace& space, design::Task task, bool perturbed, RandomStream& random);

/// One solver on one problem.
struct OuterRun {
  Eigen::VectorXd best;                                   ///< its best design, in the unit box
  double norm = std::numeric_limits<double>::infinity();  ///< |r| there, worked out from rest
  /// Between the residuals there and their gradient by a parameter that no bound holds: the largest.
  double cosine = 0;
  Ending ending = Ending::converged;
  double seconds = 0;
  int evaluations = 0;
  int jacobians = 0;
  std::vector<RecordedResiduals::Improvement> improvements;

  /// Milliseconds until |r| was at most `limit`; "none" where its best design has more.
  std::string ms_to(double limit) const;
  /// Whether |r| is from rest what it was in the search, whose equilibria start from those of the design before.
  bool on_one_branch() const;
};

OuterRun solve(const LoadedSpace& space, const OuterProblem& problem, const OuterSolver& solver);

/// "reached" up to the limit, or why not: "other_minimum", "other_branch", "stalled", "limit" or "gave_up".
std::string outcome_of(const OuterRun& run, double limit);

/// Where a problem's best design lies.
enum class Place {
  inside,    ///< no parameter at a bound
  at_bound,  ///< some are
  branches,  ///< some solver's equilibria were on another branch than those from rest
};
inline constexpr std::array<Place, 3> all_places{Place::inside, Place::at_bound, Place::branches};
std::string to_string(Place place);

/// `best` is one of the runs, which are those of all solvers on a problem.
Place place_of(const std::vector<OuterRun>& runs, const OuterRun& best);

}  // namespace supple::bench
