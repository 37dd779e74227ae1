#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "supple/tiling/part.h"

namespace supple::tiling {

/// A place where a solid is narrower than on either side of it: the two points of its outline between which a disk just
/// fits. The distance to the outline, as a function of the point within the solid, has a saddle point in their middle.
/// Eroding the solid by half the width separates it there.
struct NarrowPlace {
  Eigen::Vector2d a, b;  ///< mm
  double width() const { return (b - a).norm(); }
  Eigen::Vector2d middle() const { return (a + b) / 2; }
};

struct NarrowPlaces {
  std::vector<NarrowPlace> below;         ///< places narrower than the limit, in the order of the outline
  std::optional<double> narrowest_other;  ///< width of the narrowest other place, mm; none if there is no other
};

/// Finds the narrow places of a face; how its polygons were made does not matter. A narrow place lies between a
/// re-entrant corner of the outline and the nearest corner or side opposite. An acute corner has none, since the solid
/// gets ever wider from its tip on, and neither has the dead end of a beam. Walls of constant width count at their
/// ends, where the solid widens. `limit` and `usual_width` are in mm; most walls are about as wide as the latter. O(n
/// log n) for n corners, if few of them are nearer to each other than the usual width: about 1 us for each.
NarrowPlaces narrow_places(const SolidFace& face, double limit, double usual_width);

}  // namespace supple::tiling
