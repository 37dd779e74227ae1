#include "supple/design/verification.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "sampled_profile.h"
#include "supple/base/parallel_tasks.h"
#include "supple/microscale/accurate_simulation.h"
#include "supple/tiling/mesh.h"

namespace supple::design {
namespace {

/// One path of equilibria from rest, which reaches the strains of these samples in this order.
struct Path {
  double direction = 0;
  std::vector<std::size_t> samples;
};

/// Stress over strain has one path in tension and one in compression. Other tasks have one path for each direction.
std::vector<Path> paths_of(const std::vector<Sample>& samples) {
  std::vector<Path> paths;
  if (samples.empty()) return paths;
  if (samples.front().task != Task::stress_strain) {
    for (std::size_t i = 0; i < samples.size(); ++i) paths.push_back({samples[i].loading.direction, {i}});
    return paths;
  }
  for (const bool tension : {true, false}) {
    Path path{samples.front().loading.direction, {}};
    for (std::size_t i = 0; i < samples.size(); ++i)
      if ((samples[i].loading.strain >= 0) == tension) path.samples.push_back(i);
    std::sort(path.samples.begin(), path.samples.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(samples[a].loading.strain) < std::abs(samples[b].loading.strain);
    });
    if (!path.samples.empty()) paths.push_back(std::move(path));
  }
  return paths;
}

double value_of(const ProfileSamples& profile, const Sample& sample, const microscale::State& state) {
  if (state.stopped != microscale::Stop::converged) return std::numeric_limits<double>::quiet_NaN();
  return profile_value(profile.task, profile.measure, sample.loading.direction, sample.loading.strain, state.stress,
                       state.tangent);
}

}  // namespace

Eigen::VectorXd simulate_profile(const tiling::Structure& structure, const ProfileSamples& profile,
                                 const microscale::SimulationOptions& options, const Execution& execution) {
  const auto start = std::chrono::steady_clock::now();
  const auto samples = samples_of(profile);
  const auto paths = paths_of(samples);
  auto path_options = options;
  path_options.tangents = profile.task != Task::stress_strain;
  path_options.deformed_meshes = false;
  execution.checkpoint(0, "meshing");
  const auto cell = tiling::mesh_structure(structure, options.mesh, execution);
  Eigen::VectorXd y =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(samples.size()), std::numeric_limits<double>::quiet_NaN());
  parallel_tasks(static_cast<int>(paths.size()), execution, "verification", [&](int index, const Execution& inner) {
    const Path& path = paths[static_cast<std::size_t>(index)];
    microscale::Simulator simulator(cell, path_options, inner);
    microscale::UniaxialLoad load{path.direction, {}, microscale::LoadFrame::material};
    for (const std::size_t i : path.samples) load.stretches.push_back(std::sqrt(1 + 2 * samples[i].loading.strain));
    const auto result = simulator.run(load, inner);
    // Each path writes its own entries of y.
    for (std::size_t k = 0; k < result.states.size(); ++k)
      y[static_cast<Eigen::Index>(path.samples[k])] = value_of(profile, samples[path.samples[k]], result.states[k]);
  });
  if (execution.cost) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    execution.cost->add_effect("verification", true, "the request asks for it", static_cast<std::int64_t>(paths.size()),
                               seconds);
  }
  return y;
}

microscale::SimulationOptions verification_options(const microscale::Material& material) {
  return microscale::accurate_options(material);
}

SimulateProfile simulation_of(const tiling::Family& family, const microscale::SimulationOptions& options) {
  return
      [family, options](const Eigen::VectorXd& parameters, const ProfileSamples& samples, const Execution& execution) {
        const auto structure =
            tiling::make_structure(family, {parameters.data(), static_cast<std::size_t>(parameters.size())});
        return simulate_profile(structure, samples, options, execution);
      };
}

RestTangent rest_tangent_of(const tiling::Family& family, const microscale::Material& material) {
  microscale::SimulationOptions options;
  options.material = material;
  options.contact = options.patch = options.buckling = Switch::off;
  return [family, options](const Eigen::VectorXd& parameters, double width_factor, const Execution& execution) {
    const auto structure = tiling::make_structure(tiling::with_beam_width_factor(family, width_factor),
                                                  {parameters.data(), static_cast<std::size_t>(parameters.size())});
    microscale::GreenStrainLoad rest;
    rest.strains.emplace_back(Eigen::Vector3d::Zero());
    return microscale::simulate(structure, rest, options, execution).states.at(0).tangent;
  };
}

FamilySimulation verification_of(const tiling::Family& family, const microscale::Material& material) {
  const auto options = verification_options(material);
  auto coarser = options;
  coarser.refinement = microscale::Refinement::off;
  return {simulation_of(family, options), simulation_of(family, coarser), microscale::extrapolation_error_ratio(),
          rest_tangent_of(family, material)};
}

std::optional<double> relative_difference(const Eigen::VectorXd& simulated, const Eigen::VectorXd& model) {
  double difference = 0;
  double size = 0;
  for (Eigen::Index i = 0; i < simulated.size(); ++i) {
    if (!std::isfinite(simulated[i])) continue;
    difference += std::pow(simulated[i] - model[i], 2);
    size += std::pow(simulated[i], 2);
  }
  if (size == 0) return std::nullopt;
  return std::sqrt(difference / size);
}

}  // namespace supple::design
