#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Cracks of a surface: it is open there only because corners that belong together differ, mostly in their last digits.
struct Cracks {
  std::vector<std::int32_t> first;  ///< for each vertex, the earliest one that it belongs to, or itself
  std::int64_t vertices = 0;        ///< vertices that belong to an earlier one
  double gap = 0;                   ///< the largest distance of such a vertex from its first one, in mesh units
};

/// How to treat places where more than two boundary edges coincide.
enum class MultipleEdges {
  separate,  ///< they are no cracks, because joining them would make an edge with more than two faces
  joined,    ///< boundary edges of equal coordinates are joined, as when files without vertex numbers are read
};

/// Finds the cracks of a surface. Two edges with one face each form a crack if their end points belong together in
/// pairs. End points belong together if they are equal, or else within 4 units in the last place of single precision at
/// the largest coordinate, or else within 1e-5 of the bounding box's diagonal (the last of six digits). The three
/// distances are tried in this order, each on the edges that are still open.
///
/// Further conditions prevent wrong joints: the distance is at most 1/8 of the shortest edge at either end point;
/// exactly two edges coincide (otherwise see MultipleEdges); and the two faces are not folded onto each other. So
/// vertices inside a surface are never joined, and neither are the sides of thin walls and of thin sheets.
///
/// Degenerate faces are ignored. Faces need not agree in orientation, and edges may have more than two faces. All
/// vertices of faces must exist and be finite. O(n), plus O(b log b) for the b edges with one face.
Cracks find_cracks(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                   MultipleEdges multiple_edges, const Execution& execution = {});

}  // namespace supple::surface
