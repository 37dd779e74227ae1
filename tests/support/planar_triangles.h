#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/base/random.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::testing {

/// A corner of a closed polyline in the plane: its position and its vertex.
struct RingCorner {
  Eigen::Vector2d at;
  std::int32_t vertex;
};
using Ring = std::vector<RingCorner>;

/// Triangulates a polygon with holes by ear clipping. It uses every corner, also those within straight edges, and no
/// triangle is degenerate. The outer ring is counterclockwise, holes are clockwise. With `careful` it clips the best
/// shaped ear each time, otherwise any ear, which gives slivers and long fans. Throws std::runtime_error if no ear is
/// left. O(n^3).
std::vector<surface::Triangle> planar_triangles(Ring outer, std::vector<Ring> holes, bool careful,
                                                RandomStream& stream);

}  // namespace supple::testing
