#pragma once

#include <memory>
#include <string>
#include <vector>

#include "network_bench.h"
#include "supple/embedded/network_builders.h"

/// Studies of membranes on the stretched torus of [Thesis, fig. 3.6.] Each writes sections of membranes.md.
namespace supple::bench {

/// A torus that is stretched along the x axis, step by step, and a membrane round all of it that is at rest at first.
struct StretchedTorus {
  std::string name;
  std::shared_ptr<const surface::TriangleMesh> rest;
  embedded::Network membrane;
  /// Only the half x > 0 is stretched, or all of it.
  bool one_sided = true;
  int steps = 50;        ///< number of steps in which x doubles
  int max_steps = 1000;  ///< the path ends after this number of steps

  std::shared_ptr<const surface::TriangleMesh> mesh_at(int step) const;
};
/// A membrane of random points, no two nearer than `radius`, on a torus of around^2 faces.
StretchedTorus stretched_torus(const NetworkSettings& settings, bool one_sided, double radius, std::uint64_t seed,
                               int around = 48);
/// The thesis's torus of 2,304 faces with a membrane of 141 points.
StretchedTorus thesis_torus(const NetworkSettings& settings, bool one_sided);

struct PathOptions {
  double gradient = 1e-6;  ///< converged once |g| is at most this
  Switch mollifier = Switch::off;
  double mollifier_length = 1e-6;
  Switch kept_strips = Switch::automatic;
};
struct PathStep {
  std::shared_ptr<const surface::TriangleMesh> mesh;
  std::vector<surface::SurfacePoint> start;
  embedded::Relaxation result;
  CostLedger cost;
  double cpu_seconds = 0;  ///< of the relaxation, without mesh and solver
  double wall_seconds = 0;
  double host_seconds = 0;  ///< CPU time of the mesh's new shape and of the solver
};
/// Stretches the torus step by step. Each step starts with the barycentric coordinates of the step before.
std::vector<PathStep> follow_path(const StretchedTorus& scene, const PathOptions& options);

/// Sums over the steps of a path.
struct PathSummary {
  std::vector<double> iterations;  ///< of each step
  int all_iterations = 0;
  int not_converged = 0;
  double cpu = 0;
  double wall = 0;
  double host = 0;

  explicit PathSummary(const std::vector<PathStep>& path);
};

/// Writes the sections "accuracy" and "refinement" of membranes.md.
void study_membrane_accuracy(const NetworkSettings& settings);
void study_membrane_paths(const NetworkSettings& settings);
void study_membrane_effects(const NetworkSettings& settings);

}  // namespace supple::bench
