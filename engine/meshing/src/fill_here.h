#pragma once

#include "supple/meshing/tetrahedral_mesh.h"

namespace supple::meshing {

/// `fill` by this process' gmsh, whatever helpers it has.
TetrahedralMesh fill_here(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                          const FillOptions& options, const Execution& execution);

}  // namespace supple::meshing
