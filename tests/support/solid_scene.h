#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "network_state.h"
#include "solid_elements.h"
#include "supple/embedded/host.h"
#include "supple/meshing/tetrahedral_mesh.h"
#include "supple/numerics/system.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::testing {

/// The surface of the box [0, size] in grid cells of two triangles each.
inline surface::TriangleMesh box(const Eigen::Vector3d& size, const Eigen::Vector3i& cells) {
  std::vector<Eigen::Vector3d> positions;
  std::vector<surface::Triangle> faces;
  std::map<std::tuple<int, int, int>, std::int32_t> vertices;
  const auto vertex = [&](const Eigen::Vector3i& at) {
    const auto [entry, is_new] =
        vertices.try_emplace({at[0], at[1], at[2]}, static_cast<std::int32_t>(positions.size()));
    if (is_new) positions.emplace_back(at.cast<double>().cwiseQuotient(cells.cast<double>()).cwiseProduct(size));
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int first = (axis + 1) % 3;
    const int second = (axis + 2) % 3;
    for (const bool far : {false, true})
      for (int i = 0; i < cells[first]; ++i)
        for (int j = 0; j < cells[second]; ++j) {
          const auto corner = [&](int di, int dj) {
            Eigen::Vector3i at;
            at[axis] = far ? cells[axis] : 0;
            at[first] = i + di;
            at[second] = j + dj;
            return vertex(at);
          };
          const std::int32_t a = corner(0, 0);
          const std::int32_t b = corner(1, 0);
          const std::int32_t c = corner(1, 1);
          const std::int32_t d = corner(0, 1);
          if (far) {
            faces.push_back({a, b, c});
            faces.push_back({a, c, d});
          } else {
            faces.push_back({a, c, b});
            faces.push_back({a, d, c});
          }
        }
  }
  return surface::TriangleMesh::build(std::move(positions), std::move(faces));
}

/// A solid without a network, for the minimizer.
struct SolidScene {
  using State = embedded::NetworkState;

  explicit SolidScene(surface::TriangleMesh mesh, const meshing::FillOptions& options = {})
      : surface(std::make_shared<const surface::TriangleMesh>(std::move(mesh))),
        solid(meshing::fill(surface->positions(), surface->faces(), options)) {}

  /// A state whose nodes are the images of the nodes at rest under `place`.
  State state(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place,
              std::vector<surface::SurfacePoint> points = {}) const {
    std::vector<Eigen::Vector3d> positions;
    Eigen::VectorXd nodes(3 * static_cast<Eigen::Index>(solid.nodes.size()));
    for (std::size_t i = 0; i < solid.nodes.size(); ++i) {
      const Eigen::Vector3d at = place(solid.nodes[i]);
      nodes.segment<3>(3 * static_cast<Eigen::Index>(i)) = at;
      if (i < static_cast<std::size_t>(solid.surface_vertices)) positions.push_back(at);
    }
    auto moved = std::make_shared<const surface::TriangleMesh>(surface->with_positions(std::move(positions)));
    return {std::make_shared<surface::GeodesicSolver>(std::move(moved)), std::move(points), std::move(nodes)};
  }
  State at_rest() const {
    return state([](const Eigen::Vector3d& place) { return place; });
  }

  /// The system of the solid's elements, and of gravity if the host has it. Nodes are fixed if `held` is true for their
  /// position at rest.
  numerics::System<State> system(const embedded::SolidHost& host, State start,
                                 const std::function<bool(const Eigen::Vector3d&)>& held) const {
    std::vector<bool> fixed(static_cast<std::size_t>(start.dimension()), true);
    for (std::size_t i = 0; i < solid.nodes.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        fixed[static_cast<std::size_t>(start.node_row(static_cast<std::int32_t>(i))) + k] = held(solid.nodes[i]);
    return {std::move(start),
            {std::make_shared<embedded::SolidElements>(solid, host),
             std::make_shared<embedded::Gravity>(solid, host.gravity)},
            numerics::Unknowns(fixed)};
  }

  std::shared_ptr<const surface::TriangleMesh> surface;
  meshing::TetrahedralMesh solid;
};

}  // namespace supple::testing
