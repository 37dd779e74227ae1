#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/meshing/tetrahedral_mesh.h"

namespace supple::meshing {

/// A closed surface in a frame, a unit of length and an order of its own, so that a body gets the same tetrahedra
/// however it lies in space, in whatever unit it is given, and however its vertices and triangles are numbered.
///
/// The frame is defined by the centre and two vertices, which are distinguished from all others by quantities that
/// depend neither on the position of the body nor on the numbering: distances from the centre, lengths of edges, and
/// the same quantities of neighbours and their neighbours. Vertices of a symmetric surface may remain
/// indistinguishable. Then the one farthest along x (then y, z) is chosen, so that the frame depends on the position,
/// but not on the numbering.
struct CanonicalSurface {
  std::vector<Eigen::Vector3d> positions;  ///< positions of the vertices that triangles use, sorted, on a grid of 2^-30
  std::vector<SurfaceTriangle> faces;      ///< sorted; counterclockwise seen from outside if all components are solids
  std::vector<std::int32_t> vertices;      ///< for each vertex, its number in the given surface

  Eigen::Vector3d centre;
  Eigen::Matrix3d rotation;  ///< rotation from the given frame to this one
  double length = 1;         ///< root mean square of the distances from the centre, in the given unit

  /// The coordinates of a point of this frame in the given frame.
  Eigen::Vector3d given(const Eigen::Vector3d& point) const { return centre + length * (rotation.transpose() * point); }
};

/// O(n log n) for each refinement of the vertices' labels by those of neighbours; shapes without symmetry take a few.
CanonicalSurface canonical_surface(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces);

}  // namespace supple::meshing
