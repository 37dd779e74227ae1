#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "beams.h"
#include "supple/tiling/mesh.h"

namespace supple::tiling {

/// Linear triangles anywhere in the plane that cover the solid of one cell, modulo the lattice.
struct TriangleSoup {
  std::vector<Eigen::Vector2d> points;
  std::vector<std::uint8_t> seam;  ///< whether the point is to be merged with others at the same place of the torus
  std::vector<std::array<int, 3>> triangles;  ///< counterclockwise
};

/// Wraps the triangles on the torus: merges seam points that coincide modulo the lattice and adds the midpoints of
/// sides. The sides that remain with one triangle are the outline, whose length must be `outline_length` (mm). Throws
/// "tiling.mesh_not_periodic", which names places where sides do not match.
PeriodicMesh wrap(const TriangleSoup& soup, const Eigen::Matrix2d& lattice, double outline_length);

}  // namespace supple::tiling
