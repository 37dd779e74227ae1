#include <algorithm>
#include <vector>

#include "solver_implementation.h"
#include "strip_geodesic.h"
#include "supple/base/parallel_tasks.h"
#include "supple/surface/vertex_cone.h"

namespace supple::surface {
namespace {

/// Number of pairs of one task. It is large, so that starting tasks costs little, and small enough that all threads end
/// at about the same time.
constexpr std::size_t pairs_per_task = 128;

/// The angle at which the path to `neighbour` leaves an end that lies on a vertex; NaN for other ends.
double leaving_angle(const TriangleMesh& mesh, const SurfacePoint& end, const SurfacePoint& neighbour) {
  const int corner = corner_of(end);
  if (corner < 0) return std::numeric_limits<double>::quiet_NaN();
  return VertexCone(mesh, mesh.faces()[index(end.face)][corner]).angle_to(neighbour);
}

/// The angle that turns coordinates in the frame of `to_face` into those of `from_face`, unfolded across their common
/// edge; 0 if they have none.
double turn_across_common_edge(const SearchMesh& mesh, std::int32_t from_face, std::int32_t to_face) {
  const Strip strip = adjusted_strip(*mesh.mesh, {}, from_face, to_face);
  return strip.known() ? turn_across(mesh, strip.halfedges[0]) : 0;
}

TangentGeodesic search_pair(const GeodesicSolver& solver, const SearchMesh& search_mesh, const PointPair& pair,
                            const Execution& execution, std::vector<PathPoint>* path_result) {
  const TriangleMesh& mesh = solver.mesh();
  Geodesic geodesic =
      solver.geodesic(pair.from, pair.to, {.derivatives = 1, .path = true}, execution, {.known_path = pair.known_path});
  TangentGeodesic result;
  result.distance = geodesic.distance;
  if (geodesic.unreachable) return result;
  result.unique = geodesic.unique;
  if (!geodesic.derivatives) {
    result.turn = turn_across_common_edge(search_mesh, index(pair.from.face), index(pair.to.face));
    return result;
  }
  result.from_direction = -geodesic.derivatives->tangent_gradient.head<2>();
  result.to_direction = geodesic.derivatives->tangent_gradient.tail<2>();
  const auto& path = geodesic.path;
  result.pinned = !geodesic.pinned_at.empty();
  result.first_length = result.last_length = geodesic.distance;
  if (result.pinned) {
    const auto is_pin = [&](const PathPoint& point) {
      return point.vertex != VertexId::none &&
             std::ranges::find(geodesic.pinned_at, point.vertex) != geodesic.pinned_at.end();
    };
    double length = 0;
    std::size_t i = 1;
    for (; i + 1 < path.size(); ++i) {
      length += (path[i].position - path[i - 1].position).norm();
      if (is_pin(path[i])) break;
    }
    result.first_length = length;
    length = 0;
    for (i = path.size() - 1; i-- > 1;) {
      length += (path[i].position - path[i + 1].position).norm();
      if (is_pin(path[i])) break;
    }
    result.last_length = length;
  } else {
    result.strip = strip_of(mesh, pair.from, pair.to, path);
  }
  if (path.size() >= 2) {
    result.from_angle = leaving_angle(mesh, pair.from, path[1].point);
    result.to_angle = leaving_angle(mesh, pair.to, path[path.size() - 2].point);
  }
  if (path_result) *path_result = std::move(geodesic.path);
  return result;
}

bool on_vertex(const PointPair& pair) { return corner_of(pair.from) >= 0 || corner_of(pair.to) >= 0; }

}  // namespace

PathCounts GeodesicSolver::tangent_geodesics(std::span<const PointPair> pairs, std::span<TangentGeodesic> found,
                                             bool strips_known, const Execution& execution,
                                             std::span<std::vector<PathPoint>> paths) const {
  const SearchMesh& search_mesh = *implementation_->search_mesh;
  const auto find = [&](const PointPair& pair, const Strip& known_strip, const Execution& task_execution,
                        PathCounts& counts, std::vector<PathPoint>* path) {
    if (path) path->clear();
    const std::int32_t from_face = index(pair.from.face);
    const std::int32_t to_face = index(pair.to.face);
    if (from_face == to_face) {
      ++counts.same_face;
      TangentGeodesic straight = within_face(search_mesh, pair.from, pair.to);
      if (!straight.coincident()) {
        straight.from_angle = leaving_angle(mesh(), pair.from, pair.to);
        straight.to_angle = leaving_angle(mesh(), pair.to, pair.from);
        if (path) *path = {{pair.from, position(mesh(), pair.from)}, {pair.to, position(mesh(), pair.to)}};
      }
      return straight;
    }
    if (!path && !on_vertex(pair)) {
      const Strip strip = adjusted_strip(mesh(), strips_known ? known_strip : Strip{}, from_face, to_face);
      if (strip.known()) {
        if (auto straight = within_strip(search_mesh, pair.from, pair.to, strip)) {
          ++counts.unfolded;
          return *straight;
        }
      }
    }
    ++counts.searched;
    return search_pair(*this, search_mesh, pair, task_execution, path);
  };

  const std::size_t tasks = (pairs.size() + pairs_per_task - 1) / pairs_per_task;
  std::vector<PathCounts> counts(tasks);
  parallel_tasks(static_cast<int>(tasks), execution, "search", [&](int t, const Execution& task_execution) {
    const auto task = static_cast<std::size_t>(t);
    const std::size_t end = std::min(pairs.size(), (task + 1) * pairs_per_task);
    // The elapsed time is billed once for all tasks, so the searches bill quantities only.
    CostLedger windows;
    const Execution quantities_only{task_execution.cancellation, nullptr, task_execution.cost ? &windows : nullptr};
    for (std::size_t i = task * pairs_per_task; i < end; ++i)
      found[i] = find(pairs[i], found[i].strip, quantities_only, counts[task], paths.empty() ? nullptr : &paths[i]);
    if (!task_execution.cost) return;
    for (const auto& quantity : windows.quantities()) task_execution.cost->add_quantity(quantity.name, quantity.value);
  });
  PathCounts total;
  for (const PathCounts& count : counts) total += count;
  return total;
}

}  // namespace supple::surface
