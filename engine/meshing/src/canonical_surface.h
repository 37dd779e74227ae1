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
/// The frame comes from two vertices that are told from all others by what does not depend on position and number:
/// distances from the centre, lengths of edges, and the same of their neighbours, as often as this tells more vertices
/// apart. Vertices of a symmetric surface cannot be told apart in this way; of these, the one that lies farthest along
/// x is taken (then y, z), so that the numbers still do not matter, but the position does.
struct CanonicalSurface {
  std::vector<Eigen::Vector3d> positions;  ///< of the vertices that triangles use, sorted, on a grid of 2^-30
  std::vector<SurfaceTriangle> faces;      ///< sorted; counterclockwise seen from outside if all components are solids
  std::vector<std::int32_t> vertices;      ///< the number in the given surface of each vertex

  Eigen::Vector3d centre;
  Eigen::Matrix3d turn;  ///< from the given frame to this one
  double length = 1;     ///< root mean square of the distances from the centre, in the given unit

  /// A point of this frame in the given one.
  Eigen::Vector3d given(const Eigen::Vector3d& point) const { return centre + length * (turn.transpose() * point); }
};

/// O(n log n) for each time that neighbours tell more vertices apart, which is a few times for shapes without symmetry.
CanonicalSurface canonical_surface(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces);

}  // namespace supple::meshing
