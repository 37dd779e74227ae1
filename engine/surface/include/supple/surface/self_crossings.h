#pragma once

#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// A place where a surface crosses itself: an edge of one face runs through another face.
struct SelfCrossing {
  std::int32_t face = 0;     ///< that has the edge
  std::int32_t crossed = 0;  ///< face through which the edge runs
  Eigen::Vector3d place;     ///< the point where they meet, in mesh units
};

/// The first places, up to `most`, where the surface crosses itself, by ascending face. Only what is certain in double
/// precision counts: that surfaces touch, or fold back on themselves exactly, is not found. O(n log n) for surfaces
/// whose faces are of similar sizes.
std::vector<SelfCrossing> find_self_crossings(const TriangleMesh& mesh, std::size_t most,
                                              const Execution& execution = {});

/// Throws "solid.self_crossing" where the surface crosses itself, with the first 20 places: "face 17" crosses
/// "face 230 at (1, 2, 3)". For surfaces that are to be filled.
void require_no_self_crossings(const TriangleMesh& mesh, const Execution& execution = {});

}  // namespace supple::surface
