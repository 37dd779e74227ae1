// Scenes and timed runs that the studies of networks share.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "bill.h"
#include "measurement.h"
#include "network_bench.h"
#include "supple/embedded/network_builders.h"
#include "support/shapes.h"

namespace supple::bench {

using embedded::Network;
using surface::SurfacePoint;
using surface::TriangleMesh;

const Eigen::Vector3d near_vertex(0.99, 1e-6, 1 - 0.99 - 1e-6);
const Eigen::Vector3d on_edge(0.5, 0.5 - 1e-6, 1e-6);

double Scene::tolerance_for(double gradient) const {
  double largest = 0;
  for (const embedded::Spring& spring : network.springs) largest = std::max(largest, spring.weight);
  return gradient / (mesh->diagonal() * largest);
}

Scene face_scene(std::string name, TriangleMesh mesh, const Eigen::Vector3d& barycentric) {
  Scene scene{std::move(name), testing::share(std::move(mesh)), {}};
  scene.network.points = embedded::points_in_faces(*scene.mesh, barycentric);
  const auto pairs = embedded::pairs_of_adjacent_faces(*scene.mesh, scene.network.points);
  const double weight = 1 / (2 * static_cast<double>(pairs.size()));
  for (const auto& [a, b] : pairs) {
    scene.network.springs.push_back({a, b, 0, weight});
    scene.network.springs.push_back({b, a, 0, weight});
  }
  return scene;
}

std::vector<Scene> face_scenes(const NetworkSettings& settings) {
  std::vector<Scene> scenes;
  scenes.push_back(face_scene("torus, near vertices", testing::torus(24, 12), near_vertex));
  if (settings.brief) return scenes;
  scenes.push_back(face_scene("torus, on edges", testing::torus(24, 12), on_edge));
  scenes.push_back(face_scene("three holes, near vertices", testing::genus3(4), near_vertex));
  scenes.push_back(face_scene("three holes, on edges", testing::genus3(4), on_edge));
  scenes.push_back(face_scene("knot, near vertices", testing::trefoil_knot(80, 12), near_vertex));
  scenes.push_back(face_scene("knot, on edges", testing::trefoil_knot(80, 12), on_edge));
  return scenes;
}

Scene random_scene(std::string name, TriangleMesh mesh, double radius, std::size_t fixed_every) {
  Scene scene{std::move(name), testing::share(std::move(mesh)), {}};
  const surface::GeodesicSolver solver(scene.mesh);
  scene.network.points = embedded::poisson_disk_points(solver, radius);
  const auto edges = embedded::triangulate(solver, scene.network.points).edges;
  for (const auto& [a, b] : edges) scene.network.springs.push_back({a, b, 0, 1 / static_cast<double>(edges.size())});
  for (std::size_t i = 0; i < scene.network.points.size(); i += fixed_every)
    scene.network.fixed_points.push_back(static_cast<std::int32_t>(i));
  return scene;
}

namespace {

/// A sector of a cone with its face and the unit vectors along its two sides.
struct Sector {
  FaceId face = FaceId::none;
  int first = 0;  ///< corners of the face on the two sides
  int second = 0;
  double begin = 0;  ///< angle of its first side in the development
  double angle = 0;
  Eigen::Vector3d along_first;
  Eigen::Vector3d along_second;
};

Sector sector_at(const TriangleMesh& mesh, int sectors, double angle) {
  Sector sector;
  const double total = mesh.vertex_angle(0);
  sector.angle = total / sectors;
  const int i = std::clamp(static_cast<int>(angle / sector.angle), 0, sectors - 1);
  sector.begin = i * sector.angle;
  const std::int32_t first = 1 + i;
  const std::int32_t second = 1 + (i + 1) % sectors;
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    const surface::Triangle& face = mesh.faces()[f];
    const auto corner = [&](std::int32_t vertex) {
      return static_cast<int>(std::find(face.begin(), face.end(), vertex) - face.begin());
    };
    if (corner(0) == 3 || corner(first) == 3 || corner(second) == 3) continue;
    sector.face = FaceId{f};
    sector.first = corner(first);
    sector.second = corner(second);
  }
  if (sector.face == FaceId::none) throw std::logic_error("not a cone of one ring");
  sector.along_first = (mesh.positions()[first] - mesh.positions()[0]).normalized();
  sector.along_second = (mesh.positions()[second] - mesh.positions()[0]).normalized();
  return sector;
}

/// Coordinates along the two sides of the vector of that length and direction.
Eigen::Vector2d along_sides(const Sector& sector, double length, double direction) {
  const double angle = direction - sector.begin;
  const double second = length * std::sin(angle) / std::sin(sector.angle);
  return {length * std::cos(angle) - second * std::cos(sector.angle), second};
}

}  // namespace

SurfacePoint cone_point(const TriangleMesh& mesh, int sectors, double r, double angle) {
  const Sector sector = sector_at(mesh, sectors, angle);
  const Eigen::Vector2d along = along_sides(sector, r, angle);
  SurfacePoint point;
  point.face = sector.face;
  point.barycentric.setConstant(1 - along.sum());
  point.barycentric[sector.first] = along[0];
  point.barycentric[sector.second] = along[1];
  return surface::checked_point(mesh, point);
}

Eigen::Vector2d cone_tangent(const TriangleMesh& mesh, int sectors, double angle, double direction) {
  const Sector sector = sector_at(mesh, sectors, angle);
  const Eigen::Vector2d along = along_sides(sector, 1, direction);
  return surface::tangent_frame(mesh, sector.face).transpose() *
         (along[0] * sector.along_first + along[1] * sector.along_second);
}

TimedRun timed_run(const surface::GeodesicSolver& solver, const Network& network, embedded::RelaxationOptions options,
                   bool with_positions) {
  TimedRun run;
  Execution execution;
  execution.cost = &run.cost;
  // What the observer itself takes is not the solver's.
  double cpu_apart = 0;
  double wall_apart = 0;
  const double cpu_start = cpu_seconds();
  const double wall_start = wall_seconds();
  options.observer = [&](const embedded::RelaxationStep& step, std::span<const SurfacePoint> points,
                         const TriangleMesh&) {
    const double cpu = cpu_seconds();
    const double wall = wall_seconds();
    TimedStep timed;
    timed.step = step;
    timed.cpu_seconds = cpu - cpu_apart;
    timed.wall_seconds = wall - wall_apart;
    timed.search = stage_seconds(run.cost, "search");
    timed.host_derivatives = stage_seconds(run.cost, "host_derivatives");
    timed.assembly = stage_seconds(run.cost, "assembly");
    timed.solve = stage_seconds(run.cost, "step");
    timed.motion = stage_seconds(run.cost, "motion");
    if (with_positions) timed.positions = positions_of(solver.mesh(), {points.begin(), points.end()});
    run.steps.push_back(std::move(timed));
    cpu_apart += cpu_seconds() - cpu;
    wall_apart += wall_seconds() - wall;
  };
  run.result = embedded::relax(solver, network, options, execution);
  run.cpu_seconds = cpu_seconds() - cpu_start - cpu_apart;
  run.wall_seconds = wall_seconds() - wall_start - wall_apart;
  if (run.steps.empty()) return run;
  const TimedStep start = run.steps.front();
  for (TimedStep& step : run.steps) {
    step.cpu_seconds -= start.cpu_seconds;
    step.wall_seconds -= start.wall_seconds;
    step.search -= start.search;
    step.host_derivatives -= start.host_derivatives;
    step.assembly -= start.assembly;
    step.solve -= start.solve;
    step.motion -= start.motion;
  }
  return run;
}

TimedRun fastest_run(int repetitions, bool by_cpu, const surface::GeodesicSolver& solver, const Network& network,
                     const embedded::RelaxationOptions& options) {
  TimedRun best;
  for (int i = 0; i < repetitions; ++i) {
    TimedRun run = timed_run(solver, network, options);
    const bool faster = by_cpu ? run.cpu_seconds < best.cpu_seconds : run.wall_seconds < best.wall_seconds;
    if (i == 0 || faster) best = std::move(run);
  }
  return best;
}

std::vector<Eigen::Vector3d> positions_of(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(points.size());
  for (const SurfacePoint& point : points) positions.push_back(surface::position(mesh, point));
  return positions;
}

double largest_distance(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

}  // namespace supple::bench
