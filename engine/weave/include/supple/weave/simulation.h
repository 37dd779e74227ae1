#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/weave/equilibrium.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// A place of a strand that is fixed or moved. If the place is a crossing, the crossing is fixed.
struct Support {
  int strand = 0;
  double coordinate = 0;                       ///< arc length, mm
  std::array<bool, 3> held{true, true, true};  ///< whether x, y and z are fixed
  /// The displacement of the fixed components at the end of the path, mm.
  Eigen::Vector3d displacement{0, 0, 0};
  /// Whether the strand's direction is fixed too and turned by the rotation vector `rotation` (rad; in the plane only
  /// its z component counts). A clamp is not possible where the strand slides through a crossing.
  bool clamped = false;
  Eigen::Vector3d rotation{0, 0, 0};
};

/// A force of constant direction (a dead load) on a place of a strand.
struct PointForce {
  int strand = 0;
  double coordinate = 0;           ///< mm
  Eigen::Vector3d force{0, 0, 0};  ///< N, at the end of the path
};

/// A load path from rest, along which all loads grow in proportion. To push a strand, move a support at its end.
struct SheetLoad {
  std::vector<Support> supports;
  std::vector<PointForce> forces;
  int states = 1;  ///< number of reported states, which are spaced evenly along the path
};

struct SheetState {
  double share = 0;                                   ///< fraction of the loads, (0, 1]
  double energy = 0;                                  ///< N mm, without the forces' potential
  std::vector<std::vector<Eigen::Vector3d>> strands;  ///< deformed polylines, mm
  std::vector<Eigen::Vector3d> crossings;             ///< positions, mm
  std::vector<double> sliding;             ///< displacement of every member that slides, crossing by crossing; mm
  std::vector<Eigen::Vector3d> reactions;  ///< forces on the sheet at each support's fixed components, N
  bool out_of_plane = false;
  bool stable = true;
  Stop stopped = Stop::converged;
  double residual = 0;     ///< |g|, N; at most `tolerance` if it converged
  double tolerance = 0;    ///< N
  double limit_error = 0;  ///< see CellState::limit_error
  /// Estimates of the errors of `energy` (N mm) and of each of `reactions` (N) because of the rods' resolution and
  /// sliders short of their limits; NaN if they were not estimated.
  double energy_error = std::numeric_limits<double>::quiet_NaN();
  double reaction_error = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;  ///< Newton iterations since the previous state
  int load_steps = 0;
  int branches = 0;  ///< unstable equilibria that were left since the previous state
};

struct SimulationResult {
  /// One state for each requested state. If the path ended early there are fewer, and the last one says why. If the
  /// deadline or a limit of memory ended it, the last one is an equilibrium nevertheless.
  std::vector<SheetState> states;
  std::string message;  ///< why it ended early; empty if it did not
  int unknowns = 0;     ///< number of unknowns of the largest system
};

/// Computes the equilibria of a weave without a lattice along a load path. Each equilibrium starts from the previous
/// one with all its unknowns and frames. A path that cannot be followed to its end is no error, and neither is a
/// deadline or a limit of memory after the first state (the stop is taken back, CancellationToken::resume). Throws what
/// `validate` throws, "weave.invalid_load" (a place that is on no strand or fixed twice, a clamp on a sliding strand,
/// numbers that are not finite, no supports), and "weave.invalid_option". Each load step takes some Newton iterations,
/// each of which takes O(n^1.5) for n crossings. Bills every term and the effects.
SimulationResult simulate(const Weave& weave, const SheetLoad& load, const EquilibriumOptions& options = {},
                          const Execution& execution = {});

}  // namespace supple::weave
