#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// A periodic mesh that is cut open, as it is drawn. A node becomes one point for each lattice shift with which a
/// triangle uses it. Points and triangles are in the order of the periodic mesh's triangles.
struct UnwrappedMesh {
  struct Point {
    int node = 0;
    tiling::LatticeShift shift;
  };
  std::vector<Point> points;
  /// Indices of points: the corners, then the midpoints of the sides 01, 12, 20.
  std::vector<std::array<int, 6>> triangles;
};

/// Unwraps a mesh. Takes O(n log n) for n triangles.
UnwrappedMesh unwrap(const tiling::PeriodicMesh& mesh);

/// The points' positions, mm: node + lattice * shift. `nodes` has the positions of the periodic mesh's nodes, and
/// `lattice` the patch's translations, at rest or in a deformed state.
Eigen::Matrix2Xd positions(const UnwrappedMesh& mesh, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& nodes);

/// The mesh as matrices with one row for each point or triangle: the points' positions, mm, and the corners of the
/// triangles, without the midpoints of their sides.
Eigen::MatrixXd vertices_of(const UnwrappedMesh& mesh, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& nodes);
Eigen::MatrixXi faces_of(const UnwrappedMesh& mesh);

}  // namespace supple::microscale
