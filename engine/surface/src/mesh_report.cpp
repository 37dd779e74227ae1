#include "supple/surface/mesh_report.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "supple/base/stop_pace.h"
#include "triangle_area.h"

namespace supple::surface {
namespace {

/// Faces with a smaller angle (radians) cause a warning, because interpolation and finite elements suffer from them.
constexpr double sliver_angle = 1e-3;
/// Relative excess over 2 pi above which a vertex is a saddle, so that rounding at flat vertices does not count.
constexpr double saddle_margin = 1e-12;

// Follows halfedges without a twin. The next one along the boundary begins where the fan of the head ends.
std::int64_t count_boundary_loops(const TriangleMesh& mesh) {
  std::vector<std::uint8_t> seen(mesh.halfedge_count(), 0);
  std::int64_t loops = 0;
  for (std::int32_t start = 0; start < mesh.halfedge_count(); ++start) {
    if (mesh.twin(start) >= 0 || seen[start]) continue;
    ++loops;
    for (std::int32_t h = start; !seen[h]; h = mesh.outgoing(mesh.head(h))) seen[h] = 1;
  }
  return loops;
}

}  // namespace

MeshReport report(const TriangleMesh& mesh, const Execution& execution) {
  StopPace pace(execution.cancellation);
  MeshReport result;
  result.vertices = mesh.vertex_count();
  result.faces = mesh.face_count();
  result.components = mesh.component_count();
  result.warnings = mesh.warnings();
  if (mesh.face_count() == 0) return result;

  result.edge_min = std::numeric_limits<double>::infinity();
  result.smallest_angle = std::numeric_limits<double>::infinity();
  std::int64_t slivers = 0;
  const auto& p = mesh.positions();
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    pace.check();
    const auto& [a, b, c] = mesh.faces()[f];
    result.area += 0.5 * doubled_area(p[a], p[b], p[c]).norm();
    double smallest = std::numeric_limits<double>::infinity();
    for (std::int32_t h = 3 * f; h < 3 * f + 3; ++h) {
      result.edges += mesh.twin(h) < h;
      result.edge_min = std::min(result.edge_min, mesh.edge_length(h));
      result.edge_max = std::max(result.edge_max, mesh.edge_length(h));
      result.largest_angle = std::max(result.largest_angle, mesh.corner_angle(h));
      smallest = std::min(smallest, mesh.corner_angle(h));
    }
    slivers += smallest < sliver_angle;
    result.smallest_angle = std::min(result.smallest_angle, smallest);
  }
  result.edge_mean = mesh.mean_edge_length();

  result.lower = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  result.upper = -result.lower;
  std::int64_t used = 0;
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    pace.check();
    if (mesh.outgoing(v) < 0) continue;
    ++used;
    result.saddle_vertices += !mesh.is_boundary(v) && mesh.vertex_angle(v) > 2 * std::numbers::pi * (1 + saddle_margin);
    result.lower = result.lower.cwiseMin(p[v]);
    result.upper = result.upper.cwiseMax(p[v]);
  }

  result.boundary_loops = count_boundary_loops(mesh);
  const std::int64_t euler = used - result.edges + result.faces;
  result.genus = (2 * result.components - result.boundary_loops - euler) / 2;
  if (slivers > 0) {
    result.warnings.push_back(std::to_string(slivers) + (slivers == 1 ? " face has" : " faces have") +
                              " an angle below 0.001 radians.");
  }
  return result;
}

}  // namespace supple::surface
