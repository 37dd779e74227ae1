#pragma once

#include <memory>
#include <string>
#include <vector>

#include "network_bench.h"
#include "supple/embedded/network_builders.h"

/// Studies of membranes: the stretched torus of thesis fig. 3.6, what accuracy costs, and what makes descents long.
namespace supple::bench {

/// A torus that is stretched along the x axis, step by step, and a membrane round all of it that is at rest before.
struct StretchedTorus {
  std::string name;
  std::shared_ptr<const surface::TriangleMesh> rest;
  embedded::Network membrane;
  std::vector<embedded::Pair> sides;  ///< each once
  /// Only the half x > 0 is stretched, or all of it.
  bool one_sided = true;
  int steps = 50;       ///< in which x doubles
  int followed = 1000;  ///< no more of these steps are gone

  std::shared_ptr<const surface::TriangleMesh> mesh_at(int step) const;
};
/// Random points, no two nearer than `radius`, on a torus of 2 around * across faces.
StretchedTorus stretched_torus(const NetworkSettings& settings, bool one_sided, double radius, std::uint64_t seed,
                               int around = 48);
/// Of 2,304 faces, with a membrane of 141 points: that of the thesis.
StretchedTorus thesis_torus(const NetworkSettings& settings, bool one_sided);

/// Where a step's points start: with the barycentric coordinates of the step before, or as far beyond these as they
/// went in that step.
enum class PathStart { kept, continued };
struct PathOptions {
  double gradient = 1e-6;  ///< converged once |g| is at most that
  PathStart start = PathStart::kept;
  /// After an iteration by which |g| fell to no less than half, the step is doubled as long as E falls.
  bool longer_steps = false;
  Switch mollifier = Switch::automatic;
  double mollifier_length = 1e-6;
  Switch kept_strips = Switch::automatic;
  int max_iterations = 100;
};
struct PathStep {
  std::shared_ptr<const surface::TriangleMesh> mesh;
  std::vector<surface::SurfacePoint> start;
  embedded::Relaxation result;  ///< of longer steps: of their last iteration, with the number of all
  int trials = 0;               ///< energies that longer steps asked for
  CostLedger cost;
  double cpu_seconds = 0;  ///< of the relaxation with all that is made for it, without mesh and solver
  double wall_seconds = 0;
  double host_seconds = 0;  ///< CPU time of the mesh's new shape and of the solver
};
std::vector<PathStep> follow_path(const StretchedTorus& scene, const PathOptions& options);

/// How far the greater principal stretch or the inverse of the lesser is from 1, for each triangle.
std::vector<double> distortions(const std::vector<embedded::TriangleState>& triangles);

void measure_stretched_torus(Report& report, const NetworkSettings& settings);
void measure_long_descents(Report& report, const NetworkSettings& settings);
void measure_accuracy_of_membranes(Report& report, const NetworkSettings& settings);

}  // namespace supple::bench
