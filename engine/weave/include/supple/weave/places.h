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

/// The place at which a support fixes a crossing. It is on a strand that does not slide through the crossing, if there
/// is one. A clamp is possible at such a place.
StrandPlace place_of(const Crossing& crossing);

/// Finds the crossings whose position at rest lies within a box (mm), and the ends of strands there that are no
/// crossings. Crossings come first, and each of the two groups is in the weave's order. O(crossings + strands).
std::vector<StrandPlace> places_in(const Weave& weave, const Eigen::Vector2d& lower, const Eigen::Vector2d& upper);

}  // namespace supple::weave
