#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "supple/surface/retraction.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::embedded {

/// The sides from corner 0 to corners 1 and 2 of a face, as columns in its tangent coordinates.
inline Eigen::Matrix2d sides_of(const surface::TriangleMesh& mesh, FaceId face) {
  const auto& [a, b, c] = mesh.faces()[index(face)];
  Eigen::Matrix<double, 3, 2> sides;
  sides << mesh.positions()[b] - mesh.positions()[a], mesh.positions()[c] - mesh.positions()[a];
  return surface::tangent_frame(mesh, face).transpose() * sides;
}

/// The linear map of tangent coordinates on a face whose corners move, for vectors that keep their barycentric
/// coordinates.
inline Eigen::Matrix2d tangent_change(const surface::TriangleMesh& before, const surface::TriangleMesh& after,
                                      FaceId face) {
  return sides_of(after, face) * sides_of(before, face).inverse();
}

}  // namespace supple::embedded
