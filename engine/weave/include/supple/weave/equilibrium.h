#pragma once

#include <string_view>

#include "supple/base/effect_switch.h"

namespace supple::weave {

using supple::Switch;

/// Why a search for an equilibrium ended.
enum class Stop {
  converged,
  iteration_limit,  ///< the smallest load step did not converge within the iterations allowed
  step_too_small,   ///< no descent was found: a limit or a fold, or rounding
  folded_flat,      ///< a cell's area fell below a thousandth of that at rest: no width is left that bears stress
};
std::string_view to_string(Stop stop);

/// What both homogenization and simulation let one choose.
struct EquilibriumOptions {
  /// Pieces of rod between neighbouring crossings; errors fall with its square. The shear
  /// stiffness of a fused weave of straight strands is 33 % too low with 2, 11 % with 4, 3 % with 8.
  int segments = 4;
  /// An equilibrium is reached once |g| <= tolerance * EI / l^2 (N), or its rounding where that is more: g the energy's
  /// gradient by all unknowns (N, N mm), EI of the weakest strand, l the mean length of rod between crossings.
  double tolerance = 1e-6;
  int max_iterations = 100;  ///< Newton iterations for one load step before it is halved
  /// The path to a state is followed in at least so many load steps. 0: in as many as keep each to a strain of 4 %, or
  /// of sheets to a displacement of 4 % of their extent or a turn of 0.13 rad. Longer ones can miss the equilibrium
  /// that the path leads to: of sliding weaves one of several times the energy is found instead.
  int load_steps = 0;
  /// automatic: in the plane until an equilibrium that is reported is unstable there against a mode out of it, or
  /// something is held or loaded out of it. on: in space from the start, with twist. off: in the plane always.
  Switch out_of_plane = Switch::automatic;
  /// A deliberate step along the least stable mode where the tangent is not positive definite; of a cell in the plane
  /// that slides, the equilibrium of lower energy of the two that the first ridge on the way parts. automatic is on;
  /// off reports the unstable equilibrium.
  Switch buckling = Switch::automatic;
  /// Crossings of a strand keep this distance along it where one of them slides, mm; half of that at rest at most.
  double least_distance = 0.5;
  double barrier_range = 0.1;            ///< mm before a sliding limit or a neighbour where resistance sets in
  double sliding_regularization = 1e-6;  ///< N/mm, on every sliding displacement
};

/// Throws "weave.invalid_option" with a detail for each option out of range.
void validate(const EquilibriumOptions& options);

}  // namespace supple::weave
