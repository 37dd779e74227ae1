#pragma once

#include <functional>
#include <vector>

#include "supple/meshing/planar_mesh.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {

/// meshing::triangulate, whose failure is one of the structure.
inline meshing::PlanarMesh triangulate(const std::vector<meshing::PlanarFace>& faces,
                                       const std::function<double(const Eigen::Vector2d&)>& size) {
  try {
    return meshing::triangulate(faces, size);
  } catch (const meshing::MeshingFailed& failure) {
    throw TilingError(failure.code(), failure.what(), failure.details());
  }
}

}  // namespace supple::tiling
