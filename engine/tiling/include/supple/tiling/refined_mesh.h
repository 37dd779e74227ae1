#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "supple/tiling/mesh.h"

namespace supple::tiling {

/// A mesh whose triangles are divided into four, and the prolongation of displacements from the coarse mesh to it.
///
/// Nodes of the coarse mesh keep their numbers and positions: the old midpoints of sides become corners. Every
/// quadratic displacement on the coarse mesh is one on the fine mesh too, with the values that `prolong` gives.
struct RefinedMesh {
  PeriodicMesh mesh;
  /// The displacement of fine node coarse_nodes + i is the sum of weights[j] times that of coarse node nodes[j].
  struct Parent {
    std::array<int, 6> nodes;
    std::array<double, 6> weights;
  };
  std::vector<Parent> parents;
  Eigen::Index coarse_nodes = 0;

  /// Displacements of the fine nodes (one column each) from those of the coarse nodes.
  Eigen::Matrix2Xd prolong(const Eigen::Matrix2Xd& coarse) const;
};

/// Divides every triangle into four at the midpoints of its sides. Symmetries, periods and the outline stay. O(n log n)
/// for n triangles.
RefinedMesh refine(const PeriodicMesh& mesh);

}  // namespace supple::tiling
