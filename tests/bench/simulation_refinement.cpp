// Error of stress against a fine mesh, and time per state, for meshes of several sizes and gradings.
#include <algorithm>
#include <numbers>

#include "measurement.h"
#include "simulation_bench.h"
#include "supple/base/random.h"

namespace supple::bench {
namespace {

using microscale::BiaxialLoad;
using microscale::Load;
using microscale::Simulator;
using microscale::State;
using microscale::UniaxialLoad;

/// Tension, compression and a biaxial load in one random direction.
std::vector<Load> loads(RandomStream& random) {
  const double direction = random.uniform(0, std::numbers::pi);
  return {UniaxialLoad{direction, {1.05, 1.1, 1.2}}, UniaxialLoad{direction, {0.99, 0.98, 0.97}},
          BiaxialLoad{direction, {{1.0125, 0.995}, {1.025, 0.99}, {1.05, 0.98}}}};
}

/// Errors and times of one mesh, over all loads of one family.
struct MeshSample {
  std::vector<double> errors;
  double cpu_seconds = 0;
  int states = 0;
  int excluded = 0;
  void add(const MeshSample& other) {
    errors.insert(errors.end(), other.errors.begin(), other.errors.end());
    cpu_seconds += other.cpu_seconds;
    states += other.states;
    excluded += other.excluded;
  }
  double milliseconds() const { return 1e3 * cpu_seconds / std::max(1, states); }
};

/// Options that follow the branch which begins at rest: unstable equilibria are marked and not left.
microscale::SimulationOptions options_for(const std::string& family, const tiling::MeshOptions& mesh) {
  microscale::SimulationOptions options = data_set_options(family);
  options.mesh = mesh;
  options.buckling = microscale::Switch::off;
  return options;
}

MeshSample compare(const TimedPath& path, const std::vector<State>& reference, std::size_t states) {
  MeshSample sample;
  sample.cpu_seconds = path.cpu_seconds;
  sample.states = static_cast<int>(path.result.states.size());
  bool buckled = false;
  for (std::size_t i = 0; i < states; ++i) {
    buckled |= i >= reference.size() || i >= path.result.states.size() || !before_buckling(reference[i]) ||
               !before_buckling(path.result.states[i]);
    if (buckled) {
      ++sample.excluded;
    } else {
      sample.errors.push_back(stress_error(path.result.states[i], reference[i]));
    }
  }
  return sample;
}

struct FamilyStudy {
  std::vector<MeshSample> samples;           ///< by mesh
  std::vector<std::vector<double>> nodes;    ///< by mesh and design
  std::vector<std::vector<double>> meshing;  ///< seconds, by mesh and design
};

FamilyStudy study_family(const std::string& family, int designs, const std::vector<tiling::MeshOptions>& meshes,
                         const tiling::MeshOptions& reference_mesh) {
  FamilyStudy study;
  study.nodes.resize(meshes.size());
  study.meshing.resize(meshes.size());
  study.samples.resize(meshes.size());
  RandomStream random("simulation_refinement " + family, 1);
  for (const tiling::Structure& structure : random_structures(family, designs)) {
    const std::vector<Load> studied = loads(random);
    Simulator fine(structure, options_for(family, reference_mesh));
    std::vector<std::vector<State>> reference;
    for (const Load& load : studied) reference.push_back(fine.run(load).states);
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const double start = cpu_seconds();
      Simulator simulator(structure, options_for(family, meshes[m]));
      study.meshing[m].push_back(cpu_seconds() - start);
      study.nodes[m].push_back(static_cast<double>(simulator.mesh().nodes.cols()));
      for (std::size_t l = 0; l < studied.size(); ++l)
        study.samples[m].add(compare(run_timed(simulator, studied[l]), reference[l],
                                     static_cast<std::size_t>(microscale::size(studied[l]))));
    }
  }
  return study;
}

std::string error_percent(const std::vector<double>& errors, double q) {
  return errors.empty() ? "none" : number(100 * quantile(errors, q));
}

}  // namespace

void study_refinement(const SimulationSettings& settings) {
  const tiling::MeshOptions reference =
      settings.brief ? tiling::MeshOptions{1.0 / 3, 0.1} : tiling::MeshOptions{1.0 / 6, 0.08};
  std::vector<tiling::MeshOptions> meshes{{0.5, 1},   {1.0 / 3, 1}, {1, 0.1},       {0.7, 0.1}, {0.5, 0.2},
                                          {0.5, 0.1}, {0.5, 0.05},  {1.0 / 3, 0.1}, {0.25, 0.1}};
  if (settings.brief) meshes = {{0.5, 1}, {0.5, 0.1}};
  const std::vector<std::string> families =
      settings.families_or(settings.brief ? std::vector<std::string>{"IH01"} : published_families());
  const int designs = settings.designs_or(settings.brief ? 1 : 10);

  Report report(settings.folder, "simulations", "refinement", "Error against time: the mesh");
  Table by_family("simulations-refinement", {{"family", "Family"},
                                             {"mesh", "Mesh"},
                                             {"nodes", "Nodes, median"},
                                             {"meshing_ms", "Meshing, ms"},
                                             {"ms_per_state", "ms per state"},
                                             {"states", "States compared"},
                                             {"excluded", "Left out"},
                                             {"median_percent", "Error, median, %"},
                                             {"p90_percent", "90 % below, %"},
                                             {"worst_percent", "Worst, %"}});
  for (const std::string& family : families) {
    const FamilyStudy study = study_family(family, designs, meshes, reference);
    const std::string chosen = mesh_name(data_set_options(family).mesh);
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const MeshSample& all = study.samples[m];
      by_family.row({family, mesh_name(meshes[m]), count(median(study.nodes[m])), number(1e3 * mean(study.meshing[m])),
                     number(all.milliseconds()), std::to_string(all.errors.size()), std::to_string(all.excluded),
                     error_percent(all.errors, 0.5), error_percent(all.errors, 0.9), error_percent(all.errors, 1)});
      if (mesh_name(meshes[m]) == chosen && !all.errors.empty()) {
        const double middle = quantile(all.errors, 0.5), worst = quantile(all.errors, 1);
        report.target(family + ": stress error of its data set's mesh (" + chosen + ") before buckling",
                      "at most 1 % at the median, 3 % at worst",
                      number(100 * middle) + " %, " + number(100 * worst) + " %", middle <= 0.01 && worst <= 0.03);
      }
    }
  }
  report.table(by_family);
  report.image("simulations-refinement.svg", "Error against time per state");
  report.write("simulation_bench refinement", settings.brief,
               "Meshes are named by the length of a side over the beam width and the size at re-entrant corners over "
               "that elsewhere. " +
                   std::to_string(designs) +
                   " random designs per family, each under three load paths of three states in one random direction "
                   "(tension to 1.2, compression to 0.97, biaxial to (1.05, 0.98)), against the mesh " +
                   mesh_name(reference) +
                   ". States from the first one on that is unstable on either mesh (beams have buckled, or would in a "
                   "patch of 2x2 cells) are left out and counted: a slightly different buckling load moves stress "
                   "there by more than the mesh does. Errors are |*S* - *S*_ref| / |*S*_ref| in the Frobenius norm. A "
                   "state's time includes its tangent and its share of the path's load steps, not the meshing.");
}

}  // namespace supple::bench
