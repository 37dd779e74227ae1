#include "supple/embedded/network_builders.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "supple/base/error.h"
#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/base/random.h"
#include "supple/base/seeded_hash.h"
#include "supple/surface/exponential_map.h"

namespace supple::embedded {
namespace {

using surface::SurfacePoint;
using surface::TriangleMesh;

/// Places that are tried around each point [Bridson2007].
constexpr int tries_per_point = 30;
/// Area per point of the densest arrangement in the plane of points at least r apart, divided by r^2.
constexpr double min_area_per_point = std::numbers::sqrt3 / 2;
/// Average number of places per point at which the nearest point is determined.
constexpr double samples_per_point = 64;

double face_area(const TriangleMesh& mesh, std::int32_t face) {
  const auto& corners = mesh.faces()[face];
  const auto& x = mesh.positions();
  return 0.5 * (x[corners[1]] - x[corners[0]]).cross(x[corners[2]] - x[corners[0]]).norm();
}

void remove_duplicates(std::vector<Pair>& pairs) {
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

/// A uniform grid of cubes, in which the points near a place are found in a few lookups.
class CubeGrid {
 public:
  explicit CubeGrid(double edge) : edge_(edge) {}

  void add(const Eigen::Vector3d& at, std::size_t point) { cubes_[key(cube_of(at))].push_back(point); }

  /// Whether `predicate` holds for all points in the cube of a place and in the 26 cubes around it. It may be asked for
  /// points elsewhere too.
  template <class Predicate>
  bool all_near(const Eigen::Vector3d& at, const Predicate& predicate) const {
    const auto centre = cube_of(at);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k) {
          const auto cube = cubes_.find(key({centre[0] + i, centre[1] + j, centre[2] + k}));
          if (cube != cubes_.end() && !std::ranges::all_of(cube->second, predicate)) return false;
        }
    return true;
  }

 private:
  using Cube = std::array<std::int64_t, 3>;
  Cube cube_of(const Eigen::Vector3d& at) const {
    return {static_cast<std::int64_t>(std::floor(at[0] / edge_)), static_cast<std::int64_t>(std::floor(at[1] / edge_)),
            static_cast<std::int64_t>(std::floor(at[2] / edge_))};
  }
  /// Different cubes may share a key, which only costs time.
  static std::size_t key(const Cube& cube) { return SeededHash::of(cube[0], cube[1], cube[2]); }

  double edge_;
  std::unordered_map<std::size_t, std::vector<std::size_t>> cubes_;
};

class PoissonDisk {
 public:
  PoissonDisk(const surface::GeodesicSolver& solver, double radius, std::uint64_t seed, const Execution& execution)
      : solver_(solver), radius_(radius), random_("poisson_disk_points", seed), execution_(execution), cubes_(radius) {}

  std::vector<SurfacePoint> run() {
    const TriangleMesh& mesh = solver_.mesh();
    std::vector<std::vector<std::int32_t>> components(static_cast<std::size_t>(mesh.component_count()));
    for (std::int32_t f = 0; f < mesh.face_count(); ++f)
      components[static_cast<std::size_t>(mesh.component(f))].push_back(f);
    for (const auto& faces : components) {
      const std::size_t first = points_.size();
      const int any = random_.below(static_cast<int>(faces.size()));
      add({FaceId{faces[static_cast<std::size_t>(any)]}, Eigen::Vector3d::Constant(1.0 / 3)});
      // In the order in which they were added, each point gets neighbours: the front spreads over the component.
      for (std::size_t at = first; at < points_.size(); ++at) {
        execution_.cancellation.throw_if_requested();
        add_points_around(at);
      }
    }
    return std::move(points_);
  }

 private:
  void add(const SurfacePoint& point) {
    cubes_.add(surface::position(solver_.mesh(), point), points_.size());
    points_.push_back(point);
  }

  void add_points_around(std::size_t at) {
    const SurfacePoint centre = points_[at];  // a copy, since add() may reallocate points_
    const auto frame = surface::tangent_frame(solver_.mesh(), centre.face);
    for (int i = 0; i < tries_per_point; ++i) {
      const double angle = 2 * std::numbers::pi * random_.uniform();
      // The place is uniform over the area of the annulus from one radius to two.
      const double length = radius_ * std::sqrt(1 + 3 * random_.uniform());
      const Eigen::Vector3d displacement = frame * (length * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      const surface::ExponentialMap traced =
          surface::exponential_map(solver_.mesh(), centre, displacement, execution_.cancellation, false);
      if (is_free(traced.end)) add(traced.end);
    }
  }

  bool is_free(const SurfacePoint& place) const {
    const Eigen::Vector3d at = surface::position(solver_.mesh(), place);
    // No path on the surface is shorter than the straight segment: points beyond the radius in space need no search.
    return cubes_.all_near(at, [&](std::size_t other) {
      return (surface::position(solver_.mesh(), points_[other]) - at).norm() >= radius_ ||
             solver_.distance(points_[other], place) >= radius_;
    });
  }

  const surface::GeodesicSolver& solver_;
  double radius_;
  RandomStream random_;
  const Execution& execution_;
  CubeGrid cubes_;
  std::vector<SurfacePoint> points_;
};

}  // namespace

std::vector<SurfacePoint> points_in_faces(const TriangleMesh& mesh, const Eigen::Vector3d& barycentric) {
  std::vector<SurfacePoint> points;
  points.reserve(static_cast<std::size_t>(mesh.face_count()));
  for (std::int32_t f = 0; f < mesh.face_count(); ++f)
    points.push_back(surface::checked_point(mesh, {FaceId{f}, barycentric}, "points"));
  return points;
}

std::vector<SurfacePoint> poisson_disk_points(const surface::GeodesicSolver& solver, double radius, std::uint64_t seed,
                                              std::size_t max_points, const Execution& execution) {
  if (!std::isfinite(radius) || radius <= 0)
    throw Error("network.radius", "The radius must be positive.", {{"points/radius", "is " + number_text(radius)}});
  const TriangleMesh& mesh = solver.mesh();
  double area = 0;
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) area += face_area(mesh, f);
  const double max_count = area / (min_area_per_point * radius * radius);
  if (max_count > static_cast<double>(max_points))
    throw Error("network.radius", "The radius is so small that too many points fit.",
                {{"points/radius", "leaves room for about " + std::to_string(std::llround(std::min(max_count, 1e15))) +
                                       " points; the limit is " + std::to_string(max_points)}});
  return PoissonDisk(solver, radius, seed, execution).run();
}

std::vector<Pair> pairs_of_adjacent_faces(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  std::vector<std::vector<std::int32_t>> in_face(static_cast<std::size_t>(mesh.face_count()));
  for (std::size_t i = 0; i < points.size(); ++i)
    in_face[static_cast<std::size_t>(index(points[i].face))].push_back(static_cast<std::int32_t>(i));
  std::vector<Pair> pairs;
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
    const std::int32_t across = mesh.twin(h);
    if (across < h) continue;
    for (const std::int32_t a : in_face[static_cast<std::size_t>(TriangleMesh::face_of(h))])
      for (const std::int32_t b : in_face[static_cast<std::size_t>(TriangleMesh::face_of(across))])
        pairs.emplace_back(std::min(a, b), std::max(a, b));
  }
  // Two faces may have two edges in common.
  remove_duplicates(pairs);
  return pairs;
}

Triangulation triangulate(const surface::GeodesicSolver& solver, const std::vector<SurfacePoint>& points,
                          const Execution& execution) {
  const TriangleMesh& mesh = solver.mesh();
  if (points.empty()) return {};
  const surface::GeodesicField field = solver.field(points, {.keep_windows = true}, execution);
  const double per_face = samples_per_point * static_cast<double>(points.size()) / mesh.face_count();
  const int subdivisions = std::max(2, static_cast<int>(std::ceil(std::sqrt(2 * per_face))));

  std::map<std::array<std::int32_t, 3>, std::array<std::int32_t, 3>> triangles;  // sorted corners -> counterclockwise
  std::vector<Pair> edges;
  std::size_t deduplication_size = 1 << 16;
  const auto add_edge = [&](std::int32_t a, std::int32_t b) {
    if (a >= 0 && b >= 0 && a != b) edges.emplace_back(std::min(a, b), std::max(a, b));
  };
  const auto add_triangle = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
    add_edge(a, b);
    add_edge(b, c);
    add_edge(c, a);
    if (a < 0 || b < 0 || c < 0 || a == b || b == c || c == a) return;
    std::array<std::int32_t, 3> key{a, b, c};
    std::ranges::sort(key);
    triangles.try_emplace(key, std::array<std::int32_t, 3>{a, b, c});
  };
  const auto row_size = static_cast<std::size_t>(subdivisions) + 1;
  std::vector<std::int32_t> nearest(row_size * row_size);
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    execution.cancellation.throw_if_requested();
    const auto at = [&](int i, int j) -> std::int32_t& {
      return nearest[static_cast<std::size_t>(i) * row_size + static_cast<std::size_t>(j)];
    };
    for (int i = 0; i <= subdivisions; ++i)
      for (int j = 0; i + j <= subdivisions; ++j) {
        const Eigen::Vector3d w = Eigen::Vector3d(subdivisions - i - j, i, j) / subdivisions;
        at(i, j) = field.nearest_source({FaceId{f}, w});
      }
    for (int i = 0; i < subdivisions; ++i)
      for (int j = 0; i + j < subdivisions; ++j) {
        add_triangle(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < subdivisions) add_triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    // Each face finds the same edges many times. They are deduplicated whenever their number has doubled.
    if (edges.size() < deduplication_size) continue;
    remove_duplicates(edges);
    deduplication_size = std::max(deduplication_size, 2 * edges.size());
  }
  remove_duplicates(edges);
  Triangulation result;
  result.edges = std::move(edges);
  result.triangles.reserve(triangles.size());
  for (const auto& [key, corners] : triangles) result.triangles.push_back(corners);
  return result;
}

std::vector<MembraneTriangle> membrane_at_rest(const surface::GeodesicSolver& solver,
                                               const std::vector<surface::SurfacePoint>& points,
                                               const std::vector<std::array<std::int32_t, 3>>& corners, double scale,
                                               const Execution& execution) {
  Faults faults;
  const auto count = static_cast<std::int64_t>(points.size());
  for (std::size_t t = 0; t < corners.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      faults.require(
          corners[t][k] >= 0 && corners[t][k] < count, "triangles/" + std::to_string(t) + "/" + std::to_string(k),
          "is " + std::to_string(corners[t][k]) + ", but points are numbered from 0 to " + std::to_string(count - 1));
  faults.throw_if_any("network.triangle");
  // The side of two neighbouring triangles is measured once.
  std::map<Pair, std::size_t> sides;
  std::vector<surface::PointPair> pairs;
  const auto side = [&](std::size_t t, std::size_t k) {
    const std::int32_t a = corners[t][k];
    const std::int32_t b = corners[t][(k + 1) % 3];
    const auto [entry, is_new] = sides.try_emplace(std::minmax(a, b), pairs.size());
    if (is_new) pairs.push_back({points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)]});
    return entry->second;
  };
  std::vector<std::array<std::size_t, 3>> sides_of(corners.size());
  for (std::size_t t = 0; t < corners.size(); ++t) sides_of[t] = {side(t, 0), side(t, 1), side(t, 2)};
  std::vector<surface::TangentGeodesic> found(pairs.size());
  solver.tangent_geodesics(pairs, found, false, execution);
  std::vector<MembraneTriangle> triangles(corners.size());
  for (std::size_t t = 0; t < corners.size(); ++t) {
    triangles[t].corners = corners[t];
    for (std::size_t k = 0; k < 3; ++k) triangles[t].rest_lengths[k] = scale * found[sides_of[t][k]].distance;
  }
  return triangles;
}

}  // namespace supple::embedded
