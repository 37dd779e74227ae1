#pragma once

#include <functional>
#include <vector>

#include "supple/surface/triangle_mesh.h"

namespace supple::testing {

/// Vertices and faces of a shape during its construction.
struct Soup {
  std::vector<Eigen::Vector3d> positions;
  std::vector<surface::Triangle> faces;

  std::int32_t add(const Eigen::Vector3d& p) {
    positions.push_back(p);
    return static_cast<std::int32_t>(positions.size()) - 1;
  }
  /// Adds the counterclockwise quadrilateral a b c d, cut from a to c, or from b to d if `from_b`.
  void add_quad(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d, bool from_b = false);
  void append(const Soup& other, const Eigen::Vector3d& offset);
  surface::TriangleMesh build() && { return surface::TriangleMesh::build(std::move(positions), std::move(faces)); }
};

enum class Wrap { none, u, both };

/// Grid of nu by nv quadrilaterals over (i, j), closed in the wrapped directions. Vertex (i, j) has the index
/// j * columns + i; `from_b` chooses the diagonals as in add_quad.
Soup parametric_grid(int nu, int nv, Wrap wrap, const std::function<Eigen::Vector3d(int i, int j)>& at,
                     bool from_b = false);

/// Surface of a union of unit cells of the integer grid. Each exposed side is divided into n by n squares. `filled`
/// says which cells of [0, size) belong to the union.
Soup cell_surface(const Eigen::Vector3i& size, int n, const std::function<bool(int x, int y, int z)>& filled);

/// Laplacian smoothing: moves every vertex halfway to the mean of its neighbours, `rounds` times.
void smooth(Soup& soup, int rounds);

}  // namespace supple::testing
