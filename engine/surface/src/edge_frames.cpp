#include "edge_frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

/// A vertex whose total angle exceeds 2 pi by less than this angle (radians) bends no path that matters, because the
/// sector behind it is narrower than the tolerance by which windows are trimmed.
constexpr double saddle_tolerance = 1e-12;

}  // namespace

bool bends_paths(const TriangleMesh& mesh, std::int32_t v) {
  return mesh.is_boundary(v) || mesh.vertex_angle(v) > 2 * std::numbers::pi + saddle_tolerance;
}

SearchMesh::SearchMesh(std::shared_ptr<const TriangleMesh> mesh_in, const Execution& execution)
    : mesh(std::move(mesh_in)) {
  StopPace pace(execution.cancellation);
  const TriangleMesh& m = *mesh;
  frames.resize(static_cast<std::size_t>(m.halfedge_count()));
  for (std::int32_t h = 0; h < m.halfedge_count(); ++h) {
    pace.check();
    EdgeFrame& frame = frames[h];
    const std::int32_t onward = TriangleMesh::next(h);
    const std::int32_t back = TriangleMesh::previous(h);
    frame.length = m.edge_length(h);
    longest_edge = std::max(longest_edge, frame.length);
    has_needles = has_needles || m.edge_length(onward) < short_side_ratio * frame.length ||
                  m.edge_length(back) < short_side_ratio * frame.length;
    frame.left_length = m.edge_length(back);
    frame.right_length = m.edge_length(onward);
    const double angle = m.corner_angle(h);
    const double from_tail = frame.left_length * std::cos(angle);
    const double from_head = -frame.right_length * std::cos(m.corner_angle(onward));
    frame.offset_from_head = std::abs(from_head) < std::abs(from_tail);
    frame.apex_offset = frame.offset_from_head ? from_head : from_tail;
    frame.apex_y = frame.left_length * std::sin(angle);
    frame.left = m.twin(back);
    frame.right = m.twin(onward);
    frame.tail = m.tail(h);
    frame.head = m.head(h);
    frame.apex = m.tail(back);
  }
  pins_paths.resize(static_cast<std::size_t>(m.vertex_count()));
  corners.reserve(frames.size());
  first_corner.reserve(pins_paths.size() + 1);
  for (std::int32_t v = 0; v < m.vertex_count(); ++v) {
    pace.check();
    first_corner.push_back(static_cast<std::int32_t>(corners.size()));
    double polar = 0;
    const std::int32_t first = m.outgoing(v);
    for (std::int32_t h = first; h >= 0;) {
      corners.push_back({polar, m.corner_angle(h), h, m.twin(TriangleMesh::next(h))});
      polar += m.corner_angle(h);
      h = m.rotate(h);
      if (h == first) break;
    }
    pins_paths[v] = bends_paths(m, v);
  }
  first_corner.push_back(static_cast<std::int32_t>(corners.size()));
}

std::size_t SearchMesh::memory_bytes() const {
  return frames.capacity() * sizeof(EdgeFrame) + corners.capacity() * sizeof(FanCorner) +
         first_corner.capacity() * sizeof(std::int32_t) + pins_paths.capacity();
}

Eigen::Vector2d planar_point(const EdgeFrame& frame, const Eigen::Vector3d& barycentric, int side) {
  const double head = barycentric[(side + 1) % 3];
  const double apex = barycentric[(side + 2) % 3];
  return {head * frame.length + apex * frame.apex_x(), apex * frame.apex_y};
}

Eigen::Vector3d across_side(const SurfacePoint& point, int side, std::int32_t across) {
  Eigen::Vector3d other = Eigen::Vector3d::Zero();
  other[across % 3] = point.barycentric[(side + 1) % 3];
  other[(across + 1) % 3] = point.barycentric[side];
  return other;
}

}  // namespace supple::surface
