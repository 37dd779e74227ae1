#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Where a surface is open only because corners that belong together differ, mostly in their last digits.
struct Cracks {
  std::vector<std::int32_t> first;  ///< of each vertex the earliest one that it belongs to; itself where there is none
  std::int64_t vertices = 0;        ///< vertices that belong to an earlier one
  double gap = 0;                   ///< the greatest distance of such a vertex from its first one, in mesh units
};

/// What counts as a crack where more than two edges meet in one place.
enum class Crossings {
  apart,   ///< nothing: to join them would make an edge of more than two faces
  joined,  ///< edges of equal coordinates, as wherever files without vertex numbers are read
};

/// Finds the cracks of a surface. Two edges with one face each lie on a crack if both of their ends belong together:
/// if they are equal; or no further apart than 4 units in the last place of single precision at the largest
/// coordinate; or than 1e-5 of the bounding box's diagonal, which is the last of six digits. The first of these three
/// that closes a crack is taken. Ends are never further apart than 1/8 of the shortest edge at either of them; exactly
/// two edges meet (see Crossings for more); and the two faces do not lie on each other. So vertices inside a surface
/// are never joined, and neither are the sides of thin walls and of thin sheets.
///
/// Degenerate faces are as if they were not there. Faces need not agree about their orientation, and the surface may
/// have edges of more faces. All vertices of faces exist and are finite. O(n), plus O(b log b) for the b edges with one
/// face.
Cracks find_cracks(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
                   Crossings crossings, const Execution& execution = {});

}  // namespace supple::surface
