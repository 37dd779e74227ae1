#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// A periodic mesh cut open, as it is drawn: a node appears once for each multiple of the translations at which some
/// triangle has it. Points and triangles are in the order of the periodic mesh's triangles.
struct UnwrappedMesh {
  struct Point {
    int node = 0;
    tiling::LatticeShift shift;
  };
  std::vector<Point> points;
  std::vector<std::array<int, 6>> triangles;  ///< points: the corners, then the midpoints of the sides 01, 12, 20
};

/// O(n log n) for n triangles.
UnwrappedMesh unwrap(const tiling::PeriodicMesh& mesh);

/// Where the points lie, mm: node + lattice * shift, for the positions of the periodic mesh's nodes and the patch's
/// translations at rest or in a deformed state.
Eigen::Matrix2Xd positions(const UnwrappedMesh& mesh, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& nodes);

}  // namespace supple::microscale
