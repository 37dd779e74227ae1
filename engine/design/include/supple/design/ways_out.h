#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/inverse_design.h"
#include "supple/design/polish.h"

namespace supple::design {

/// A change of a problem with which a design comes much closer to the target.
struct WayOut {
  enum class Change {
    turn,              ///< the orientation of the tiling
    modulus,           ///< Young's modulus of the material
    turn_and_modulus,  ///< both of them
    shorten,           ///< the range of strains of the target
    family,            ///< the family of tilings
  };
  Change change = Change::turn;
  std::string sentence{};              ///< for the user: the change, and the deviations after and before it
  std::optional<std::size_t> other{};  ///< index of the other family's space; none if the family stays
  Eigen::VectorXd parameters{};
  double orientation = 0;        ///< rad, within [0, pi)
  double youngs_modulus = 0;     ///< MPa
  std::optional<Range> range{};  ///< strains of the shortened target; none if the target stays
  /// Relative root mean square deviation of the target with the largest one: by the model, or as the sentence says.
  double deviation = 0;
  double uncertainty = 0;  ///< as Design::uncertainty
};
std::string_view to_string(WayOut::Change change);

/// The problem whose ways out are sought.
struct WaysOutSearch {
  const DesignSpace& space;             ///< the space of the design that was found
  std::span<const DesignSpace> others;  ///< spaces of other families; empty if all families were searched
  const DesignProblem& problem;
  const DesignOptions& options;  ///< those of the search for the design
  double max_seconds = 10;       ///< the search ends after this time with what it has found
};

/// Looks for ways out if `design` misses the target, which means that it deviates by more than 5 %: by its simulation
/// if there is one, and otherwise by the model. A simulation that does not reach every sample misses. Tried are, in
/// this order: turning the tiling, another modulus from 0.1 to 5000 MPa, both, the longest part of the range of strains
/// that is reached within 5 %, and the other families. Each is a search with few starting points, the design among
/// them.
///
/// Where only the simulation misses, the model alone would find the same design again. Then the modulus and the range
/// follow from the simulated values, and the orientation is sought by the model with the error that the simulation has
/// found at the design.
///
/// A way out is in the answer if the model trusts it, if its deviation is below 15 %, and if this is at most 0.7 of the
/// design's. The best one comes first. If the time or the deadline ends, or a limit of memory is reached, the answer is
/// what was found until then; any other stop request throws Cancelled. Nothing is tried for a design whose own search
/// was stopped. Takes as long as some searches for a design. Bills the stage and the effect
/// "ways_out".
std::vector<WayOut> find_ways_out(const WaysOutSearch& search, const Design& design,
                                  const std::optional<Polished>& simulated = {}, const Execution& execution = {});

}  // namespace supple::design
