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
  step_too_small,   ///< no step lowered the energy, for example at a limit point of the load or because of rounding
  folded_flat,      ///< the cell's area fell below 0.001 of its area at rest, so that it has no width to bear stress
  deadline,         ///< the deadline passed before the equilibrium was found, or after the last one of a sheet
  memory,           ///< a limit of memory was reached by then
};
std::string_view to_string(Stop stop);

/// The options that homogenization and simulation have in common.
struct EquilibriumOptions {
  /// The number of pieces of rod between neighbouring crossings. Errors fall with the square of this number. The shear
  /// stiffness of a fused weave of straight strands is 33 % too low with 2 pieces, 11 % with 4, and 3 % with 8.
  int segments = 4;
  /// Maximum turn of a curved strand within one of these pieces, rad, for which it gets more of them.
  double max_segment_turn = 0.6;
  /// An equilibrium is reached if |g| <= tolerance * EI / l^2 (N), or if |g| is at most its own rounding error. Here g
  /// is the gradient of the energy with respect to all unknowns (N, N mm), EI belongs to the weakest strand, and l is
  /// the mean length of rod between crossings.
  double tolerance = 1e-6;
  int max_iterations = 100;  ///< Newton iterations for one load step before it is halved
  /// Minimum number of load steps on the path to a state. 0 chooses as many as keep each step to a strain of 4 %, or
  /// for sheets to a displacement of 4 % of their extent or a turn of 0.13 rad. Longer steps can miss the equilibrium
  /// to which the path leads. For sliding weaves they may find one with several times the energy.
  int load_steps = 0;
  /// automatic computes in the plane until a reported equilibrium is unstable against a mode out of the plane, or until
  /// a support moves or a force acts out of it. on computes in space from the start, with twist. off always stays in
  /// the plane.
  Switch out_of_plane = Switch::automatic;
  /// Whether an equilibrium is left along its least stable mode if its tangent stiffness is not positive definite. For
  /// a planar cell with sliders, the other branch at the first bifurcation of the path is computed too, and the
  /// equilibrium of lower energy is reported. automatic means on. off reports the unstable equilibrium.
  Switch buckling = Switch::automatic;
  /// Minimum distance in mm, along a strand, between neighbouring crossings of which at least one slides. It is at most
  /// half of their distance at rest. Between a crossing and the end of its strand it is half as large. The default is
  /// the sum of the radii of the strands that cross there, at which these touch.
  std::optional<double> least_distance{};
  /// Relative error of the energy that is allowed because sliders do not stand exactly at their limits;
  /// CellState::limit_error estimates it. With 1, sliders stay where the barriers before the limits keep them.
  double limit_tolerance = 1e-6;
  /// Distance in mm from a sliding limit, or from a neighbouring crossing, at which its barrier begins to act while a
  /// path is followed. Reported states do not depend on it, unless `limit_tolerance` is 1. The default is a twentieth
  /// of the mean length of rod between crossings.
  std::optional<double> barrier_range{};
  /// Stiffness against every sliding displacement, N/mm. The default is 7e-11 times Young's modulus times the mean
  /// length of rod between crossings.
  std::optional<double> sliding_regularization{};
  /// Whether states are computed once more with half as many segments, to estimate the error that the rods' resolution
  /// makes. automatic does so for at most 24 directions or deformation gradients, evenly spread, and for no sheet. on
  /// does so for all, off for none.
  Switch error_estimate = Switch::off;
};

/// Throws "weave.invalid_option" with a detail for each option out of range.
void validate(const EquilibriumOptions& options);

}  // namespace supple::weave
