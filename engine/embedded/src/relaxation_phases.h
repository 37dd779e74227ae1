#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "constrained_points.h"
#include "elastic_network.h"
#include "host_model.h"
#include "network_search.h"
#include "network_state.h"
#include "supple/embedded/relaxation.h"
#include "supple/numerics/minimizer.h"
#include "supple/numerics/system.h"

namespace supple::embedded {

/// What all phases of a relaxation read.
struct RelaxationContext {
  /// The network is a checked one. All arguments outlive this.
  RelaxationContext(const surface::GeodesicSolver& mesh_solver, const Network& checked_network,
                    const RelaxationOptions& relaxation_options, const Execution& whole_execution);

  bool follows_geodesics() const { return options.spring_length == SpringLength::geodesic; }
  bool reuses_strips() const { return options.kept_strips != Switch::off; }
  /// Whether the host neither deforms nor moves.
  bool is_rigid() const;
  NetworkSearch::Options search_options(bool is_mollified) const;
  /// The options of every search. Its iterations are limited separately.
  numerics::MinimizerOptions minimizer_options() const;
  /// For each degree of freedom whether it is fixed, with these fixed points.
  std::vector<bool> fixed_degrees(const std::vector<bool>& fixed_points) const;

  const surface::GeodesicSolver& solver;  ///< solver on the mesh as it is given
  const Network& network;
  const RelaxationOptions& options;
  const Execution& execution;
  ConstrainedPoints points;
  std::shared_ptr<const ElasticNetwork> elements;
  HostModel host;
};

/// The steps of all phases so far, which an observer is told of, and the state after the last one.
class RelaxationHistory {
 public:
  explicit RelaxationHistory(const RelaxationOptions& options) : options_(options) {}

  /// With `fixes_more` the gradient norm of the step leaves points out that are free in the answer.
  void record(const numerics::MinimizerStep& step, const NetworkState& state, bool fixes_more = false);
  bool empty() const { return steps_.empty(); }
  std::size_t size() const { return steps_.size(); }
  const RelaxationStep& last() const { return steps_.back(); }
  /// The state after the last step; nullopt before the first one, or if states are not kept.
  const std::optional<NetworkState>& state() const { return state_; }
  /// Whether the last step was recorded with `fixes_more`.
  bool fixes_more() const { return fixes_more_; }
  /// From now on no state is kept: it would outlive its surface, which moves.
  void keep_no_states() {
    keeps_state_ = false;
    state_.reset();
  }
  /// Forgets the steps after the first `size`.
  void truncate(std::size_t size) { steps_.resize(size); }
  std::vector<RelaxationStep> take() { return std::move(steps_); }

 private:
  const RelaxationOptions& options_;
  bool keeps_state_ = true;
  std::vector<RelaxationStep> steps_;
  std::optional<NetworkState> state_;
  bool fixes_more_ = false;
};

/// Going back to an earlier load has found the same equilibrium if the energies differ by at most this fraction.
inline constexpr double same_equilibrium = 1e-7;

/// Where a phase ended and the next one begins.
struct Equilibrium {
  NetworkState state;
  std::shared_ptr<const surface::GeodesicSolver> moved_surface{};  ///< null where the surface is at its first position
  numerics::MinimizerTermination termination = numerics::MinimizerTermination::converged;
  double energy = 0;
  double gradient_norm = 0;
  int iterations = 0;  ///< total of all phases so far

  /// The solver on the present surface; `mesh_solver` is that of the mesh.
  const surface::GeodesicSolver& solver(const surface::GeodesicSolver& mesh_solver) const {
    if (moved_surface) return *moved_surface;
    return state.surface() ? *state.surface() : mesh_solver;
  }
};

/// The first phase's start: the network's points on the host at rest.
Equilibrium start_of(const RelaxationContext& context);

struct SearchSettings {
  bool is_mollified = false;
  int max_iterations = 0;  ///< limit of all phases together
  /// Points that are fixed; null for those of the context.
  const std::vector<bool>* fixed_points = nullptr;
};

/// Minimizes the energy from a state. Throws "network.collapsed" if triangles have no area there.
Equilibrium find_equilibrium(const RelaxationContext& context, const Equilibrium& from, const SearchSettings& settings,
                             RelaxationHistory& history, const Execution& execution);

/// The last state of the history, for a search that was stopped at another one. The gradient norm is that of all free
/// points, also where the search had fixed some of them. The history has a state.
Equilibrium best_of(const RelaxationContext& context, const RelaxationHistory& history);

/// Continues where a search could not lower the energy although a gradient is left, because paths under compression are
/// at their cut loci (`relaxation_jams.cpp` says how). Returns the state where it ended, with the termination
/// `step_too_small` where it could not leave the jam.
Equilibrium leave_jam(const RelaxationContext& context, Equilibrium from, const SearchSettings& settings,
                      RelaxationHistory& history, const Execution& execution);

/// An equilibrium at the last position of a host, and how all positions were reached.
struct FollowedEquilibrium {
  Equilibrium end;
  std::vector<LoadIncrement> stops;
};

/// Is told of the equilibrium at each position, and of all load increments up to there.
using OnPosition = std::function<void(const Equilibrium& end, const std::vector<LoadIncrement>& stops)>;

/// Follows the equilibrium on the mesh to those on all positions of a moving surface.
FollowedEquilibrium follow_surface(const RelaxationContext& context, Equilibrium start, const MovingHost& host,
                                   RelaxationHistory& history, const Execution& execution,
                                   const OnPosition& on_position);

/// Follows the equilibrium at rest to those with the moved vertices of a host at all of their positions.
FollowedEquilibrium follow_supports(const RelaxationContext& context, Equilibrium start, RelaxationHistory& history,
                                    const Execution& execution, const OnPosition& on_position);

/// The public name of a minimizer's termination.
RelaxationTermination relaxation_termination(numerics::MinimizerTermination termination);

/// Describes the end of all phases: lengths, energies, warnings. Adds the effects to the bill.
Relaxation describe_relaxation(const RelaxationContext& context, const FollowedEquilibrium& found, bool is_mollified,
                               RelaxationHistory history);

}  // namespace supple::embedded
