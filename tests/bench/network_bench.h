#pragma once

#include <memory>
#include <string>
#include <vector>

#include "report.h"
#include "supple/base/cost_ledger.h"
#include "supple/embedded/relaxation.h"

/// The studies of networks on surfaces, in the order of the page. Each adds its tables to the report.
namespace supple::bench {

struct NetworkSettings {
  /// Small meshes and few repetitions: shows that the program works, not what the numbers are.
  bool brief = false;
};

/// A network on a mesh of its own.
struct Scene {
  std::string name;
  std::shared_ptr<const surface::TriangleMesh> mesh;
  embedded::Network network;

  double unknowns() const { return 2 * static_cast<double>(network.points.size() - network.fixed_points.size()); }
  /// The option `tolerance` that asks for |grad E| <= gradient.
  double tolerance_for(double gradient) const;
};

/// One point in each face, and springs from it to those of the three neighbours: each pair has two, as in the scenes of
/// the thesis (3 springs for each face). Weights are 1 / (number of springs), rest lengths 0.
Scene face_scene(std::string name, surface::TriangleMesh mesh, const Eigen::Vector3d& barycentric);
/// The scenes of thesis fig. 3.4, near vertices and on edges, on closed meshes made here.
std::vector<Scene> face_scenes(const NetworkSettings& settings);
/// Random points that keep a distance of `radius` and the edges of their geodesic triangulation, of which every
/// `fixed_every`-th point stays: the others contract between these. Weights are 1 / (number of springs).
Scene random_scene(std::string name, surface::TriangleMesh mesh, double radius, std::size_t fixed_every);

/// Barycentric coordinates from which scenes start.
extern const Eigen::Vector3d near_vertex;
extern const Eigen::Vector3d on_edge;

/// The thesis ends at |g| below this.
inline constexpr double thesis_gradient = 1e-6;

/// Of the cones whose apex is the vertex that a study looks at.
inline constexpr int cone_sectors = 8;
/// The point of testing::cone(sectors, total_angle) at distance `r` from the apex, at most the cosine of half a sector,
/// in the direction `angle` of the development, whose first sector begins at 0.
surface::SurfacePoint cone_point(const surface::TriangleMesh& mesh, int sectors, double r, double angle);
/// The tangent coordinates, at a point in the direction `angle`, of the unit vector that points towards `direction` in
/// the plane of the development.
Eigen::Vector2d cone_tangent(const surface::TriangleMesh& mesh, int sectors, double angle, double direction);

/// A state on the way and what had passed when it was reached, from the start's evaluation on.
struct TimedStep {
  embedded::RelaxationStep step;
  double cpu_seconds = 0;
  double wall_seconds = 0;
  double search = 0;  ///< wall seconds by what they went into
  double host_derivatives = 0;
  double assembly = 0;
  double solve = 0;
  double motion = 0;
  std::vector<Eigen::Vector3d> positions;  ///< empty unless asked for
};
struct TimedRun {
  embedded::Relaxation result;
  std::vector<TimedStep> steps;
  CostLedger cost;
  double cpu_seconds = 0;  ///< of all of it: checks and the description of the springs included
  double wall_seconds = 0;
};
TimedRun timed_run(const surface::GeodesicSolver& solver, const embedded::Network& network,
                   embedded::RelaxationOptions options, bool with_positions = false);
/// The fastest of some equal runs, by CPU time or by wall time.
TimedRun fastest_run(int repetitions, bool by_cpu, const surface::GeodesicSolver& solver,
                     const embedded::Network& network, const embedded::RelaxationOptions& options);

std::vector<Eigen::Vector3d> positions_of(const surface::TriangleMesh& mesh,
                                          const std::vector<surface::SurfacePoint>& points);
/// The farthest that a point lies from where it is in the other list.
double largest_distance(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);

void measure_steps(Report& report, const NetworkSettings& settings);
void measure_scenes(Report& report, const NetworkSettings& settings);
void measure_methods(Report& report, const NetworkSettings& settings);
void measure_accuracy_of_networks(Report& report, const NetworkSettings& settings);
void measure_straight_springs(Report& report, const NetworkSettings& settings);
void measure_mollified_networks(Report& report, const NetworkSettings& settings);
void draw_kinds_of_vertices(Report& report, const NetworkSettings& settings);

}  // namespace supple::bench
