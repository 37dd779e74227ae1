#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "supple/tiling/part.h"

namespace supple::tiling {

/// A place where a solid is narrower than on either side of it: the two points of its outline between which a disk just
/// fits. The distance to the outline, as a function of the point within the solid, has a saddle in the middle of them.
/// Eroding the solid by half the width parts it there.
struct NarrowPlace {
  Eigen::Vector2d a, b;  ///< mm
  double width() const { return (b - a).norm(); }
  Eigen::Vector2d middle() const { return (a + b) / 2; }
};

struct NarrowPlaces {
  std::vector<NarrowPlace> below;       ///< those narrower than the limit, in the order of the outline
  std::optional<double> least_of_rest;  ///< width of the narrowest one of all others (mm); none if there is no other
};

/// Measures the polygons alone: it knows nothing about how they were made. Narrow places lie between a re-entrant
/// corner of the outline and the nearest corner or side opposite. An acute corner has none, since the solid gets ever
/// wider from its tip on, and neither has the dead end of a beam. Walls of constant width count at their ends, where
/// the solid widens. `limit` and `usual_width` are in mm; most walls are about as wide as the latter. O(n log n) for n
/// corners, if few of them are nearer to each other than the usual width: about 1 us for each.
NarrowPlaces narrow_places(const SolidFace& face, double limit, double usual_width);

}  // namespace supple::tiling
