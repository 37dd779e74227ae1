#include "supple/embedded/network_plan.h"

#include <utility>

#include "supple/base/part_of_execution.h"
#include "supple/embedded/network_builders.h"

namespace supple::embedded {
namespace {

/// Number of pairs of points in faces that share an edge; a pair is counted once for each such edge. O(points + faces).
std::size_t count_adjacent_pairs(const surface::TriangleMesh& mesh, const std::vector<surface::SurfacePoint>& points) {
  std::vector<std::size_t> in_face(static_cast<std::size_t>(mesh.face_count()));
  for (const auto& point : points) ++in_face[static_cast<std::size_t>(index(point.face))];
  std::size_t pairs = 0;
  for (std::int32_t h = 0; h < mesh.halfedge_count(); ++h) {
    if (mesh.twin(h) < h) continue;
    pairs += in_face[static_cast<std::size_t>(surface::TriangleMesh::face_of(h))] *
             in_face[static_cast<std::size_t>(surface::TriangleMesh::face_of(mesh.twin(h)))];
  }
  return pairs;
}

class Builder {
 public:
  Builder(const surface::GeodesicSolver& solver, const NetworkLimits& limits) : solver_(solver), limits_(limits) {}

  std::vector<surface::SurfacePoint> points(const std::vector<surface::SurfacePoint>& given, const Execution&) const {
    return given;
  }
  std::vector<surface::SurfacePoint> points(const PointsInFaces& rule, const Execution& execution) const {
    const StageTimer timer(execution.cost, "points");
    check("points", static_cast<std::size_t>(solver_.mesh().face_count()), limits_.points);
    return points_in_faces(solver_.mesh(), rule.barycentric);
  }
  std::vector<surface::SurfacePoint> points(const PoissonDiskPoints& rule, const Execution& execution) const {
    const StageTimer timer(execution.cost, "points");
    return poisson_disk_points(solver_, rule.radius, rule.seed, limits_.points, execution);
  }

  void add_springs(const std::vector<Spring>& given, BuiltNetwork& built, const Execution&) {
    built.network.springs = given;
  }
  void add_springs(const NeighbourSprings& rule, BuiltNetwork& built, const Execution& execution) {
    const StageTimer timer(execution.cost, "springs");
    const auto& points = built.network.points;
    std::vector<Pair> pairs;
    if (rule.kind == NeighbourSprings::Kind::adjacent_faces) {
      // The pairs are counted before they are built, since their number grows with the square of the points in a face.
      check("springs", count_adjacent_pairs(solver_.mesh(), points), limits_.springs);
      pairs = pairs_of_adjacent_faces(solver_.mesh(), points);
    } else {
      auto dual = triangulate(solver_, points, execution);
      check("springs", dual.edges.size(), limits_.springs);
      pairs = std::move(dual.edges);
      built.triangles = std::move(dual.triangles);
      from_dual_ = true;
    }
    built.network.springs.reserve(pairs.size());
    for (const auto& [from, to] : pairs) built.network.springs.push_back({from, to, rule.rest_length, rule.weight});
  }

  void add_membrane(const NetworkPlan& plan, BuiltNetwork& built, const Execution& execution) {
    if (!plan.has_membrane()) return;
    const StageTimer timer(execution.cost, "triangles");
    const auto& points = built.network.points;
    if (const auto* given = std::get_if<0>(&plan.triangles)) {
      built.triangles = *given;
    } else if (!from_dual_) {
      built.triangles = triangulate(solver_, points, execution).triangles;
    }
    check("triangles", built.triangles->size(), limits_.triangles);
    built.network.triangles = membrane_at_rest(solver_, points, *built.triangles, plan.rest_scale, execution);
    built.network.material = plan.material;
  }

 private:
  void check(std::string_view field, std::size_t count, std::size_t limit) const {
    if (count > limit) limits_.refuse(field, count);
  }

  const surface::GeodesicSolver& solver_;
  const NetworkLimits& limits_;
  bool from_dual_ = false;  ///< whether the springs' triangulation has built the triangles already
};

}  // namespace

BuiltNetwork build_network(const surface::GeodesicSolver& solver, const NetworkPlan& plan, const NetworkLimits& limits,
                           const Execution& execution) {
  Builder builder(solver, limits);
  BuiltNetwork built;
  built.network.fixed_points = plan.fixed_points;
  constexpr double fraction = 1.0 / 3;
  const PartOfExecution first(execution, 0, fraction);
  first.execution().checkpoint(0, "points");
  built.network.points =
      std::visit([&](const auto& points) { return builder.points(points, first.execution()); }, plan.points);
  const PartOfExecution second(execution, fraction, fraction);
  second.execution().checkpoint(0, "springs");
  std::visit([&](const auto& springs) { builder.add_springs(springs, built, second.execution()); }, plan.springs);
  const PartOfExecution third(execution, 2 * fraction, fraction);
  third.execution().checkpoint(0, "triangles");
  builder.add_membrane(plan, built, third.execution());
  return built;
}

}  // namespace supple::embedded
