#pragma once

#include "supple/meshing/tetrahedral_mesh.h"

namespace supple::meshing {

/// Does the same as `fill` with the gmsh of this process, even if there are helper processes.
TetrahedralMesh fill_here(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                          const FillOptions& options, const Execution& execution);

}  // namespace supple::meshing
