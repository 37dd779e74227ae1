#include "supple/surface/triangle_mesh.h"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "equal_points.h"
#include "mesh_connectivity.h"
#include "mesh_faults.h"
#include "supple/base/error.h"
#include "supple/base/stop_pace.h"
#include "triangle_area.h"

namespace supple::surface {
namespace {

std::string counted(std::int64_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::int64_t coincident_vertices(const std::vector<Eigen::Vector3d>& positions, const Execution& execution) {
  const std::vector<std::int32_t> first = first_equal_points(positions, execution);
  std::int64_t count = 0;
  for (std::size_t v = 0; v < first.size(); ++v) count += first[v] != static_cast<std::int32_t>(v);
  return count;
}

}  // namespace

TriangleMesh TriangleMesh::build(std::vector<Eigen::Vector3d> positions, std::vector<Triangle> faces,
                                 std::vector<std::string> warnings, const Execution& execution) {
  if (const std::int64_t reset_count = reset_unused_vertices(positions, faces); reset_count > 0)
    warnings.push_back(unused_vertices_warning(reset_count));
  check_references(positions, faces, execution);
  check_areas(positions, faces, execution);
  TriangleMesh mesh;
  mesh.positions_ = std::move(positions);
  mesh.faces_ = std::move(faces);
  mesh.warnings_ = std::move(warnings);
  const std::int32_t vertices = mesh.vertex_count();

  mesh.twins_ = pair_halfedges(vertices, mesh.faces_, execution);
  Orientation orientation = orient_faces(mesh.faces_, mesh.twins_, execution);
  mesh.components_ = std::move(orientation.components);
  mesh.component_count_ = orientation.component_count;
  mesh.outgoing_ = find_fans(vertices, mesh.faces_, mesh.twins_, execution);

  mesh.boundary_.assign(vertices, 0);
  std::int64_t unused = 0;
  for (std::int32_t v = 0; v < vertices; ++v) {
    const std::int32_t first = mesh.outgoing_[v];
    if (first < 0)
      ++unused;
    else
      mesh.boundary_[v] = mesh.twins_[first] < 0;
  }
  mesh.measure(execution);

  if (orientation.turned_faces > 0) {
    mesh.warnings_.push_back(counted(orientation.turned_faces, "face was", "faces were") +
                             " turned to agree with their neighbours: their second and third corner are swapped.");
  }
  if (unused > 0) mesh.warnings_.push_back(counted(unused, "vertex belongs", "vertices belong") + " to no face.");
  if (const std::int64_t coincident = coincident_vertices(mesh.positions_, execution); coincident > 0) {
    mesh.warnings_.push_back(counted(coincident, "vertex has", "vertices have") +
                             " the coordinates of an earlier one; the surface is not joined there.");
  }
  return mesh;
}

TriangleMesh TriangleMesh::with_positions(std::vector<Eigen::Vector3d> positions) const {
  if (positions.size() != positions_.size()) {
    throw Error("mesh.position_count", "The mesh cannot take another number of vertices.",
                {{"vertices",
                  "are " + std::to_string(positions.size()) + "; the mesh has " + std::to_string(positions_.size())}});
  }
  check_coordinates(positions);
  check_areas(positions, faces_);
  TriangleMesh mesh;
  mesh.positions_ = std::move(positions);
  mesh.faces_ = faces_;
  mesh.twins_ = twins_;
  mesh.outgoing_ = outgoing_;
  mesh.boundary_ = boundary_;
  mesh.components_ = components_;
  mesh.component_count_ = component_count_;
  if (!faces_.empty()) mesh.measure();
  return mesh;
}

void TriangleMesh::measure(const Execution& execution) {
  StopPace pace(execution.cancellation);
  const std::int32_t halfedges = halfedge_count();
  // Coordinates and areas were checked before, so that no square below overflows or underflows.
  lengths_.resize(halfedges);
  angles_.resize(halfedges);
  double length_sum = 0;
  std::int64_t edges = 0;
  for (std::int32_t f = 0; f < face_count(); ++f) {
    pace.check();
    const Eigen::Vector3d corners[3] = {positions_[faces_[f][0]], positions_[faces_[f][1]], positions_[faces_[f][2]]};
    const double area = doubled_area(corners[0], corners[1], corners[2]).norm();
    for (int i = 0; i < 3; ++i) {
      const std::int32_t h = 3 * f + i;
      const Eigen::Vector3d side = corners[(i + 1) % 3] - corners[i];
      lengths_[h] = side.norm();
      angles_[h] = std::atan2(area, side.dot(corners[(i + 2) % 3] - corners[i]));
      if (twins_[h] < h) {
        length_sum += lengths_[h];
        ++edges;
      }
    }
  }
  mean_edge_length_ = length_sum / static_cast<double>(edges);

  vertex_angles_.assign(positions_.size(), 0);
  Eigen::Vector3d lower = positions_[tail(0)], upper = lower;
  for (std::int32_t v = 0; v < vertex_count(); ++v) {
    pace.check();
    const std::int32_t first = outgoing_[v];
    if (first < 0) continue;
    std::int32_t h = first;
    do {
      vertex_angles_[v] += angles_[h];
      h = rotate(h);
    } while (h >= 0 && h != first);
    lower = lower.cwiseMin(positions_[v]);
    upper = upper.cwiseMax(positions_[v]);
  }
  diagonal_ = (upper - lower).norm();
}

}  // namespace supple::surface
