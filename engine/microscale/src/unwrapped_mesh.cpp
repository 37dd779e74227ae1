#include "supple/microscale/unwrapped_mesh.h"

#include <map>
#include <tuple>

#include "supple/numerics/rows.h"

namespace supple::microscale {

UnwrappedMesh unwrap(const tiling::PeriodicMesh& mesh) {
  UnwrappedMesh result;
  result.triangles.reserve(mesh.triangles.size());
  std::map<std::tuple<int, int, int>, int> point_indices;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto& triangle = result.triangles.emplace_back();
    for (std::size_t k = 0; k < 6; ++k) {
      const int node = mesh.triangles[t][k];
      const tiling::LatticeShift shift = mesh.shifts[t][k];
      const auto [place, is_new] =
          point_indices.try_emplace({node, shift.first, shift.second}, static_cast<int>(result.points.size()));
      if (is_new) result.points.push_back({node, shift});
      triangle[k] = place->second;
    }
  }
  return result;
}

Eigen::Matrix2Xd positions(const UnwrappedMesh& mesh, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& nodes) {
  Eigen::Matrix2Xd result(2, static_cast<Eigen::Index>(mesh.points.size()));
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const auto& [node, shift] = mesh.points[i];
    result.col(static_cast<Eigen::Index>(i)) = nodes.col(node) + lattice * Eigen::Vector2d(shift.first, shift.second);
  }
  return result;
}

Eigen::MatrixXd vertices_of(const UnwrappedMesh& mesh, const Eigen::Matrix2d& lattice, const Eigen::Matrix2Xd& nodes) {
  return positions(mesh, lattice, nodes).transpose();
}

Eigen::MatrixXi faces_of(const UnwrappedMesh& mesh) { return numerics::rows_of(mesh.triangles).leftCols<3>(); }

}  // namespace supple::microscale
