#pragma once

#include <optional>
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

/// The options that homogenization and simulation have in common.
struct EquilibriumOptions {
  /// The number of pieces of rod between neighbouring crossings. Errors fall with its square. The shear stiffness of a
  /// fused weave of straight strands is 33 % too low with 2 pieces, 11 % with 4, and 3 % with 8.
  int segments = 4;
  /// An equilibrium is reached if |g| <= tolerance * EI / l^2 (N), or if |g| is at most its rounding where that is
  /// more. Here g is the gradient of the energy with respect to all unknowns (N, N mm), EI belongs to the weakest
  /// strand, and l is the mean length of rod between crossings.
  double tolerance = 1e-6;
  int max_iterations = 100;  ///< Newton iterations for one load step before it is halved
  /// The path to a state is followed in at least so many load steps. With 0 there are as many steps as are needed to
  /// keep each step to a strain of 4 %, or for sheets to a displacement of 4 % of their extent or a turn of 0.13 rad.
  /// Longer steps can miss the equilibrium to which the path leads. For sliding weaves they may find one with several
  /// times the energy.
  int load_steps = 0;
  /// automatic computes in the plane until a reported equilibrium is unstable against a mode out of the plane, or until
  /// something is held or loaded out of it. on computes in space from the start, with twist. off always stays in the
  /// plane.
  Switch out_of_plane = Switch::automatic;
  /// A deliberate step along the least stable mode if the tangent is not positive definite. A cell in the plane that
  /// slides gets the equilibrium of lower energy of the two that the first ridge on the way separates. automatic means
  /// on. off reports the unstable equilibrium.
  Switch buckling = Switch::automatic;
  /// Crossings of a strand keep this distance along it if one of them slides, mm. It is at most half of their distance
  /// at rest, and half as much before the end of a strand. Without it, crossings come so near each other that the
  /// strands that cross there touch: the sum of their radii.
  std::optional<double> least_distance{};
  /// Sliders stand at their limits exactly, but for an error of the energy of at most about this share, which
  /// CellState::limit_error estimates. 1 leaves the barriers as they are.
  double limit_tolerance = 1e-6;
  /// While a path is followed, resistance begins this far before a sliding limit or a neighbour, mm. Reported states do
  /// not depend on it, unless `limit_tolerance` is 1. Without it: a twentieth of the mean length of rod between
  /// crossings.
  std::optional<double> barrier_range{};
  /// Stiffness against every sliding displacement, N/mm. Without it: 7e-11 times Young's modulus times the mean length
  /// of rod between crossings.
  std::optional<double> sliding_regularization{};
};

/// Throws "weave.invalid_option" with a detail for each option out of range.
void validate(const EquilibriumOptions& options);

}  // namespace supple::weave
