#include <algorithm>
#include <vector>

#include "solver_implementation.h"
#include "strip_geodesic.h"
#include "supple/base/parallel_tasks.h"
#include "supple/surface/vertex_cone.h"

namespace supple::surface {
namespace {

/// Pairs of one task: so many that handing them out costs little, so few that threads end together.
constexpr std::size_t pairs_of_a_task = 128;

/// Of an end on a vertex, the angle under which the path to its neighbour leaves; NaN elsewhere.
double leaving_angle(const TriangleMesh& mesh, const SurfacePoint& end, const SurfacePoint& neighbour) {
  const int corner = corner_of(end);
  if (corner < 0) return std::numeric_limits<double>::quiet_NaN();
  return VertexCone(mesh, mesh.faces()[index(end.face)][corner]).angle_to(neighbour);
}

/// What turns coordinates in the frame of `to_face` into those of `from_face`, unfolded across their common edge; 0
/// where they have none.
double turn_between(const SearchMesh& mesh, std::int32_t from_face, std::int32_t to_face) {
  const Strip strip = adjusted_strip(*mesh.mesh, {}, from_face, to_face);
  return strip.known() ? turn_across(mesh, strip.halfedges[0]) : 0;
}

TangentGeodesic searched(const GeodesicSolver& solver, const SearchMesh& search_mesh, const PointPair& pair,
                         const Execution& execution, std::vector<PathPoint>* keep) {
  const TriangleMesh& mesh = solver.mesh();
  Geodesic geodesic =
      solver.geodesic(pair.from, pair.to, {.derivatives = 1, .path = true}, execution, {.known_path = pair.known_path});
  TangentGeodesic found;
  found.distance = geodesic.distance;
  if (geodesic.unreachable) return found;
  found.unique = geodesic.unique;
  if (!geodesic.derivatives) {
    found.turn = turn_between(search_mesh, index(pair.from.face), index(pair.to.face));
    return found;
  }
  found.from_direction = -geodesic.derivatives->tangent_gradient.head<2>();
  found.to_direction = geodesic.derivatives->tangent_gradient.tail<2>();
  const auto& path = geodesic.path;
  found.pinned = !geodesic.pinned_at.empty();
  found.first_length = found.last_length = geodesic.distance;
  if (found.pinned) {
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
    found.first_length = length;
    length = 0;
    for (i = path.size() - 1; i-- > 1;) {
      length += (path[i].position - path[i + 1].position).norm();
      if (is_pin(path[i])) break;
    }
    found.last_length = length;
  } else {
    found.strip = strip_of(mesh, pair.from, pair.to, path);
  }
  if (path.size() >= 2) {
    found.from_angle = leaving_angle(mesh, pair.from, path[1].point);
    found.to_angle = leaving_angle(mesh, pair.to, path[path.size() - 2].point);
  }
  if (keep) *keep = std::move(geodesic.path);
  return found;
}

bool on_vertex(const PointPair& pair) { return corner_of(pair.from) >= 0 || corner_of(pair.to) >= 0; }

}  // namespace

PathsFound GeodesicSolver::tangent_geodesics(std::span<const PointPair> pairs, std::span<TangentGeodesic> found,
                                             bool strips_known, const Execution& execution,
                                             std::span<std::vector<PathPoint>> paths) const {
  const SearchMesh& search_mesh = *implementation_->search_mesh;
  const auto find = [&](const PointPair& pair, const Strip& known, const Execution& own, PathsFound& counts,
                        std::vector<PathPoint>* path) {
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
      const Strip strip = adjusted_strip(mesh(), strips_known ? known : Strip{}, from_face, to_face);
      if (strip.known()) {
        if (auto straight = within_strip(search_mesh, pair.from, pair.to, strip)) {
          ++counts.unfolded;
          return *straight;
        }
      }
    }
    ++counts.searched;
    return searched(*this, search_mesh, pair, own, path);
  };

  const std::size_t tasks = (pairs.size() + pairs_of_a_task - 1) / pairs_of_a_task;
  std::vector<PathsFound> counts(tasks);
  parallel_tasks(static_cast<int>(tasks), execution, "search", [&](int t, const Execution& own) {
    const auto task = static_cast<std::size_t>(t);
    const std::size_t end = std::min(pairs.size(), (task + 1) * pairs_of_a_task);
    // The time that passes is billed once, not that of every search.
    CostLedger windows;
    const Execution quiet{own.cancellation, nullptr, own.cost ? &windows : nullptr};
    for (std::size_t i = task * pairs_of_a_task; i < end; ++i)
      found[i] = find(pairs[i], found[i].strip, quiet, counts[task], paths.empty() ? nullptr : &paths[i]);
    if (!own.cost) return;
    for (const auto& quantity : windows.quantities()) own.cost->add_quantity(quantity.name, quantity.value);
  });
  PathsFound total;
  for (const PathsFound& count : counts) total += count;
  return total;
}

}  // namespace supple::surface
