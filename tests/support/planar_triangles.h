#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/base/random.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::testing {

/// A closed polyline of the plane: where each corner lies, and which vertex it is.
struct RingCorner {
  Eigen::Vector2d at;
  std::int32_t vertex;
};
using Ring = std::vector<RingCorner>;

/// Cuts a polygon with holes into triangles by ear clipping: every corner is used, also those within straight edges,
/// and no triangle is flat. The outer ring is counterclockwise, holes are clockwise. `careful` takes the best shaped
/// ear each time, otherwise any, which leaves slivers and long fans. Throws std::runtime_error if no ear is left.
/// O(n^3).
std::vector<surface::Triangle> planar_triangles(Ring outer, std::vector<Ring> holes, bool careful,
                                                RandomStream& stream);

}  // namespace supple::testing
