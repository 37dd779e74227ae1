#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "report.h"
#include "supple/base/cost_ledger.h"
#include "supple/embedded/relaxation.h"

/// The studies of networks on surfaces. Each writes a section of networks.md.
namespace supple::bench {

struct NetworkSettings {
  /// Small meshes and few repetitions: shows that the program works, not what the numbers are.
  bool brief = false;
  std::filesystem::path folder = "docs/bench";
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

/// One point in each face, with springs to the points of the three neighbours: each pair has two, as in [Thesis]
/// (3 springs for each face). Weights are 1 / (number of springs), rest lengths 0.
Scene face_scene(std::string name, surface::TriangleMesh mesh, const Eigen::Vector3d& barycentric);
/// The scenes of [Thesis, fig. 3.4], near vertices and on edges, on closed meshes made here.
std::vector<Scene> face_scenes(const NetworkSettings& settings);
/// Barycentric coordinates from which scenes start.
extern const Eigen::Vector3d near_vertex;
extern const Eigen::Vector3d on_edge;

/// [Thesis] ends at |g| below this.
inline constexpr double thesis_gradient = 1e-6;

/// A state of a run, with the times from the first evaluation until it was reached.
struct TimedStep {
  embedded::RelaxationStep step;
  double cpu_seconds = 0;
  double wall_seconds = 0;
  double search = 0;  ///< wall seconds, by stage
  double host_derivatives = 0;
  double assembly = 0;
  double solve = 0;
  double motion = 0;
};
struct TimedRun {
  embedded::Relaxation result;
  std::vector<TimedStep> steps;
  CostLedger cost;
  double cpu_seconds = 0;  ///< of the whole call, checks and the description of the springs included
  double wall_seconds = 0;
};
TimedRun timed_run(const surface::GeodesicSolver& solver, const embedded::Network& network,
                   embedded::RelaxationOptions options);
/// The fastest of some equal runs, by CPU time or by wall time.
TimedRun fastest_run(int repetitions, bool by_cpu, const surface::GeodesicSolver& solver,
                     const embedded::Network& network, const embedded::RelaxationOptions& options);

std::vector<Eigen::Vector3d> positions_of(const surface::TriangleMesh& mesh,
                                          const std::vector<surface::SurfacePoint>& points);
/// The largest distance of a point from the same point of the other list.
double largest_distance(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b);

void study_network_accuracy(const NetworkSettings& settings);
void study_network_effects(const NetworkSettings& settings);
void study_network_steps(const NetworkSettings& settings);
void study_network_scenes(const NetworkSettings& settings);

}  // namespace supple::bench
