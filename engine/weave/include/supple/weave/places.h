#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

/// A place on a strand.
struct StrandPlace {
  int strand = 0;
  double coordinate = 0;  ///< arc length from the strand's start at rest, mm
};

/// Where a crossing is held: on a strand that does not slide through it, where there is one, which can be clamped too.
StrandPlace place_of(const Crossing& crossing);

/// Crossings whose rest position lies within a box (mm), and ends of strands there that are no crossings: crossings
/// first, each kind in the weave's order. O(crossings + strands).
std::vector<StrandPlace> places_in(const Weave& weave, const Eigen::Vector2d& lower, const Eigen::Vector2d& upper);

}  // namespace supple::weave
