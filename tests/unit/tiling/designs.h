#pragma once

#include <vector>

#include "supple/base/random.h"
#include "supple/tiling/mesh.h"
#include "supple/tiling/structure.h"
#include "support/preset_structure.h"

namespace supple::tiling::testing {

using supple::testing::preset_structure;
using supple::testing::presets;

/// Uniform in the family's box, widened by `margin` of its width on either side.
std::vector<double> random_parameters(const Family& family, RandomStream& random, double margin = 0);

/// The sum over all translates of the polygons by the tiling's lattice of their winding numbers around the point.
int windings(const Tiling& tiling, const std::vector<std::vector<Polygon>>& polygons, const Eigen::Vector2d& point);

/// Expects what every mesh of the structure promises: counterclockwise triangles of the solid's area; each side shared
/// by two triangles that agree on its place or on the outline; midpoints in the middle; one loop of outline per hole,
/// with the hole on its right.
void expect_sound(const PeriodicMesh& mesh, const Structure& structure);

/// Same nodes, triangles, shifts and outline, bit by bit.
bool identical(const PeriodicMesh& a, const PeriodicMesh& b);

}  // namespace supple::tiling::testing
