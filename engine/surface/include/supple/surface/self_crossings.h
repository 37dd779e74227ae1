#pragma once

#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// A place where a surface crosses itself: an edge of one face runs through another face.
struct SelfCrossing {
  std::int32_t face = 0;     ///< the face that has the edge
  std::int32_t crossed = 0;  ///< the face that the edge intersects
  Eigen::Vector3d place;     ///< the point where they meet, in mesh units
};

/// The first places, at most `max_count`, where the surface crosses itself, in ascending order of faces. Only crossings
/// that are certain in double precision count: surfaces that touch, or that fold back on themselves exactly, are not
/// found. O(n log n) if the faces are of similar sizes.
std::vector<SelfCrossing> find_self_crossings(const TriangleMesh& mesh, std::size_t max_count,
                                              const Execution& execution = {});

/// Throws "solid.self_crossing" if the surface crosses itself, with the first 20 places: "face 17" crosses "face 230 at
/// (1, 2, 3)". Surfaces that are to be filled with tetrahedra need this check.
void require_no_self_crossings(const TriangleMesh& mesh, const Execution& execution = {});

}  // namespace supple::surface
