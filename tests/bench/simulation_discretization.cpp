// What a simulation says of its mesh's error, against a fine mesh; and what that costs. Long: it goes on where it was
// interrupted.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>

#include "measurement.h"
#include "simulation_bench.h"
#include "supple/base/random.h"
#include "supple/microscale/accurate_simulation.h"

namespace supple::bench {
namespace {

using microscale::Load;
using microscale::Refinement;
using microscale::Simulator;
using microscale::State;
using microscale::UniaxialLoad;

/// How a structure is simulated.
struct Way {
  std::string name;
  tiling::MeshOptions mesh;
  Refinement refinement = Refinement::off;
};

/// The reference comes first.
std::vector<Way> ways(bool brief) {
  if (brief) return {{"reference", {0.5, 0.1}, Refinement::extrapolated}, {"default", microscale::extrapolated_mesh(), Refinement::extrapolated}};
  return {{"reference", {0.35, 0.05}, Refinement::extrapolated},
          {"before", {0.5, 0.1}, Refinement::off},
          {"estimated", {0.5, 0.1}, Refinement::estimated},
          {"default", microscale::extrapolated_mesh(), Refinement::extrapolated}};
}

struct StudiedLoad {
  std::string name;
  Load load;
};

std::vector<StudiedLoad> loads(RandomStream& random) {
  const double direction = random.uniform(0, std::numbers::pi);
  return {{"tension", UniaxialLoad{direction, {1.02, 1.05, 1.1}}},
          {"compression", UniaxialLoad{direction, {0.99, 0.975, 0.95}}}};
}

double frobenius(const Eigen::Vector3d& t) { return std::sqrt(t[0] * t[0] + t[1] * t[1] + 2 * t[2] * t[2]); }

void write_rows(std::ostream& out, const std::string& family, int design, const StudiedLoad& load, const Way& way,
                const TimedPath& path, double meshing, int nodes, const std::vector<State>& reference) {
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (i >= path.result.states.size()) break;
    const State& state = path.result.states[i];
    const State& wanted = reference[i];
    const bool same = state.stopped == microscale::Stop::converged && wanted.stopped == microscale::Stop::converged &&
                      state.branch == wanted.branch && state.cells == wanted.cells;
    out << family << ',' << design << ',' << load.name << ',' << way.name << ',' << i << ',' << nodes << ','
        << number(meshing, 4) << ',' << number(path.cpu_seconds, 4) << ',' << (same ? 1 : 0) << ',' << state.branch << ','
        << state.cells << ',' << number(frobenius(wanted.stress), 6) << ','
        << number(frobenius(state.stress - wanted.stress), 4) << ','
        << (state.mesh_error ? number(state.mesh_error->stress, 4) : "") << ',' << number(wanted.energy_density, 6) << ','
        << number(std::abs(state.energy_density - wanted.energy_density), 4) << ','
        << (state.mesh_error ? number(state.mesh_error->energy_density, 4) : "") << '\n';
  }
}

void study_design(std::ostream& out, const std::string& family, int design, const tiling::Structure& structure,
                  const std::vector<StudiedLoad>& studied, const std::vector<Way>& studied_ways) {
  std::map<std::string, std::vector<State>> reference;
  for (const Way& way : studied_ways) {
    microscale::SimulationOptions options;
    options.mesh = way.mesh;
    options.refinement = way.refinement;
    std::optional<Simulator> simulator;
    const double meshing = cpu_time([&] { simulator.emplace(structure, options); });
    const int nodes = static_cast<int>(simulator->mesh().nodes.cols());
    for (const StudiedLoad& load : studied) {
      const TimedPath path = run_timed(*simulator, load.load);
      if (way.name == "reference") reference[load.name] = path.result.states;
      write_rows(out, family, design, load, way, path, meshing, nodes, reference[load.name]);
    }
  }
}

}  // namespace

void study_discretization(const SimulationSettings& settings) {
  const std::vector<Way> studied_ways = ways(settings.brief);
  const auto families = settings.families_or(settings.brief ? std::vector<std::string>{"IH01"} : published_families());
  const int designs = settings.designs_or(settings.brief ? 1 : 30);
  const auto file = settings.folder / "simulations-discretization-states.csv";
  std::set<std::string> done;
  {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      std::istringstream fields(line);
      std::string family, design;
      if (std::getline(fields, family, ',') && std::getline(fields, design, ',')) done.insert(family + "," + design);
    }
  }
  std::ofstream out(file, std::ios::app);
  if (done.empty())
    out << "family,design,load,way,state,nodes,meshing_s,cpu_s,same_branch,branch,cells,stress,stress_error,"
           "stress_estimate,energy,energy_error,energy_estimate\n";
  for (int design = 0; design < designs; ++design) {
    for (const std::string& family : families) {
      if (done.count(family + "," + std::to_string(design)) > 0) continue;
      RandomStream random("simulation_discretization " + family + " " + std::to_string(design), 1);
      const std::vector<tiling::Structure> structures = random_structures(family, design + 1);
      // All rows of a design at once, so that what is on disk is whole designs.
      std::ostringstream rows;
      study_design(rows, family, design, structures.back(), loads(random), studied_ways);
      out << rows.str() << std::flush;
    }
  }
}

}  // namespace supple::bench
