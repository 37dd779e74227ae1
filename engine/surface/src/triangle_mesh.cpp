#include "supple/surface/triangle_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "equal_points.h"
#include "mesh_connectivity.h"
#include "mesh_faults.h"
#include "triangle_area.h"

namespace supple::surface {
namespace {

std::string counted(std::int64_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::int64_t coincident_vertices(const std::vector<Eigen::Vector3d>& positions) {
  const std::vector<std::int32_t> first = first_equal_points(positions);
  std::int64_t count = 0;
  for (std::size_t v = 0; v < first.size(); ++v) count += first[v] != static_cast<std::int32_t>(v);
  return count;
}

}  // namespace

TriangleMesh TriangleMesh::build(std::vector<Eigen::Vector3d> positions, std::vector<Triangle> faces,
                                 std::vector<std::string> warnings) {
  check_references(positions, faces);
  check_areas(positions, faces);
  TriangleMesh mesh;
  mesh.positions_ = std::move(positions);
  mesh.faces_ = std::move(faces);
  mesh.warnings_ = std::move(warnings);
  const std::int32_t vertices = mesh.vertex_count();
  const std::int32_t halfedges = mesh.halfedge_count();

  mesh.twins_ = pair_halfedges(vertices, mesh.faces_);
  Orientation orientation = orient_faces(mesh.faces_, mesh.twins_);
  mesh.components_ = std::move(orientation.components);
  mesh.component_count_ = orientation.component_count;
  mesh.outgoing_ = find_fans(vertices, mesh.faces_, mesh.twins_);

  // The checks bound coordinates and areas, so that no square below overflows or underflows.
  mesh.lengths_.resize(halfedges);
  mesh.angles_.resize(halfedges);
  double length_sum = 0;
  std::int64_t edges = 0;
  for (std::int32_t h = 0; h < halfedges; ++h) {
    const Eigen::Vector3d& at = mesh.positions_[mesh.tail(h)];
    const Eigen::Vector3d& ahead = mesh.positions_[mesh.head(h)];
    const Eigen::Vector3d& apex = mesh.positions_[mesh.tail(previous(h))];
    mesh.lengths_[h] = (ahead - at).norm();
    mesh.angles_[h] = std::atan2(doubled_area(at, ahead, apex).norm(), (ahead - at).dot(apex - at));
    if (mesh.twins_[h] < h) {
      length_sum += mesh.lengths_[h];
      ++edges;
    }
  }
  mesh.mean_edge_length_ = length_sum / static_cast<double>(edges);

  mesh.boundary_.assign(vertices, 0);
  mesh.vertex_angles_.assign(vertices, 0);
  std::int64_t unused = 0;
  Eigen::Vector3d lower = mesh.positions_[mesh.tail(0)], upper = lower;
  for (std::int32_t v = 0; v < vertices; ++v) {
    const std::int32_t first = mesh.outgoing_[v];
    if (first < 0) {
      ++unused;
      continue;
    }
    mesh.boundary_[v] = mesh.twins_[first] < 0;
    std::int32_t h = first;
    do {
      mesh.vertex_angles_[v] += mesh.angles_[h];
      h = mesh.rotate(h);
    } while (h >= 0 && h != first);
    lower = lower.cwiseMin(mesh.positions_[v]);
    upper = upper.cwiseMax(mesh.positions_[v]);
  }
  mesh.diagonal_ = (upper - lower).norm();

  if (orientation.turned_faces > 0) {
    mesh.warnings_.push_back(counted(orientation.turned_faces, "face was", "faces were") +
                             " turned to agree with their neighbours: their second and third corner are swapped.");
  }
  if (unused > 0) mesh.warnings_.push_back(counted(unused, "vertex belongs", "vertices belong") + " to no face.");
  if (const std::int64_t coincident = coincident_vertices(mesh.positions_); coincident > 0) {
    mesh.warnings_.push_back(counted(coincident, "vertex has", "vertices have") +
                             " the coordinates of an earlier one; the surface is not joined there.");
  }
  return mesh;
}

}  // namespace supple::surface
