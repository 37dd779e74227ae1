#pragma once

#include <vector>

#include "supple/base/random.h"
#include "supple/tiling/mesh.h"
#include "supple/tiling/structure.h"
#include "support/preset_structure.h"

namespace supple::tiling::testing {

using supple::testing::preset_structure;

/// Random parameters, uniform in the family's box, which is widened by `margin` of its width on either side.
std::vector<double> random_parameters(const Family& family, RandomStream& random, double margin = 0);

/// The sum of the winding numbers of polygons around the point, over all translates by the tiling's lattice.
int windings(const Tiling& tiling, const std::vector<std::vector<Polygon>>& polygons, const Eigen::Vector2d& point);

/// Expects the properties of every mesh of the structure: the triangles are counterclockwise and have the solid's area;
/// each side is on the outline, or belongs to two triangles that agree about its position; midpoints are in the middle;
/// each hole has one loop of the outline, which has the hole on its right.
void expect_sound(const PeriodicMesh& mesh, const Structure& structure);

/// Whether nodes, triangles, shifts and outlines are the same, bit by bit.
bool identical(const PeriodicMesh& a, const PeriodicMesh& b);

}  // namespace supple::tiling::testing
