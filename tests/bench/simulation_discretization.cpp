// The error of its mesh that a simulation states, against the error that a fine mesh shows, and its cost. A run takes
// hours and goes on where it was interrupted.
#include <algorithm>
#include <cmath>
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

/// A way to simulate a structure.
struct Way {
  std::string name;
  tiling::MeshOptions mesh;
  Refinement refinement = Refinement::off;
};

/// The reference comes first.
std::vector<Way> ways(const std::string& family, bool brief) {
  if (brief)
    return {{"reference", {0.5, 0.1}, Refinement::extrapolated},
            {"default", microscale::extrapolated_mesh(), Refinement::extrapolated}};
  // Slender beams bend along their length, for which longer triangles are as good.
  const bool slender = tiling::family(family).sufficient_mesh_size > tiling::default_mesh_size;
  return {{"reference", {slender ? 0.5 : 0.35, 0.05}, Refinement::extrapolated},
          {"before", {0.5, 0.1}, Refinement::off},
          {"estimated", {0.5, 0.1}, Refinement::estimated},
          {"default", microscale::extrapolated_mesh(), Refinement::extrapolated}};
}

struct NamedPath {
  std::string name;
  Load load;
};

std::vector<NamedPath> uniaxial_paths(RandomStream& random) {
  const double direction = random.uniform(0, std::numbers::pi);
  return {{"tension", UniaxialLoad{direction, {1.02, 1.05, 1.1}}},
          {"compression", UniaxialLoad{direction, {0.99, 0.975, 0.95}}}};
}

void write_rows(std::ostream& out, const std::string& family, int design, const NamedPath& load, const Way& way,
                const TimedPath& path, double meshing, int nodes, const std::vector<State>& reference) {
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (i >= path.result.states.size()) break;
    const State& state = path.result.states[i];
    const State& wanted = reference[i];
    const bool same = state.stopped == microscale::Stop::converged && wanted.stopped == microscale::Stop::converged &&
                      state.branch == wanted.branch && state.cells == wanted.cells;
    out << family << ',' << design << ',' << load.name << ',' << way.name << ',' << i << ',' << nodes << ','
        << number(meshing, 4) << ',' << number(path.cpu_seconds, 4) << ',' << (same ? 1 : 0) << ',' << state.branch
        << ',' << state.cells << ',' << number(frobenius(wanted.stress), 6) << ','
        << number(frobenius(state.stress - wanted.stress), 4) << ','
        << (state.mesh_error ? number(state.mesh_error->stress, 4) : "") << ',' << number(wanted.energy_density, 6)
        << ',' << number(std::abs(state.energy_density - wanted.energy_density), 4) << ','
        << (state.mesh_error ? number(state.mesh_error->energy_density, 4) : "") << '\n';
  }
}

void study_design(std::ostream& out, const std::string& family, int design, const tiling::Structure& structure,
                  const std::vector<NamedPath>& studied, const std::vector<Way>& studied_ways) {
  std::map<std::string, std::vector<State>> reference;
  for (const Way& way : studied_ways) {
    microscale::SimulationOptions options;
    options.mesh = way.mesh;
    options.refinement = way.refinement;
    std::optional<Simulator> simulator;
    const double meshing = cpu_time([&] { simulator.emplace(structure, options); });
    const int nodes = static_cast<int>(simulator->mesh().nodes.cols());
    for (const NamedPath& load : studied) {
      const TimedPath path = run_timed(*simulator, load.load);
      if (way.name == "reference") reference[load.name] = path.result.states;
      write_rows(out, family, design, load, way, path, meshing, nodes, reference[load.name]);
    }
  }
}

/// A path of one design in one way, summed up from the file of all states.
struct StudiedPath {
  double error = 0, stress = 0, estimate = 0;  // sums of squares over states
  double energy_error = 0, energy = 0, energy_estimate = 0;
  double seconds = 0;  // of the path and its share of the meshing
  bool same_branch = true;
  bool estimated = true;
};
/// Paths by family, way of simulating, design and load.
using StudiedPaths = std::map<std::string, std::map<std::string, std::map<std::string, StudiedPath>>>;

StudiedPaths read_paths(const std::filesystem::path& file) {
  StudiedPaths paths;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> cells;
    std::istringstream fields(line);
    for (std::string cell; std::getline(fields, cell, ',');) cells.push_back(cell);
    cells.resize(17);
    const auto square = [&](std::size_t cell) { return cells[cell].empty() ? 0 : std::pow(std::stod(cells[cell]), 2); };
    StudiedPath& path = paths[cells[0]][cells[3]][cells[1] + " " + cells[2]];
    path.seconds = std::stod(cells[6]) / 2 + std::stod(cells[7]);
    path.same_branch = path.same_branch && cells[8] == "1";
    path.estimated = path.estimated && !cells[13].empty();
    path.stress += square(11);
    path.error += square(12);
    path.estimate += square(13);
    path.energy += square(14);
    path.energy_error += square(15);
    path.energy_estimate += square(16);
  }
  return paths;
}

double percent_of(double error, double size) { return 100 * std::sqrt(error / size); }

/// Writes the section from all designs that are in the file.
void write_section(const SimulationSettings& settings, const std::filesystem::path& file) {
  Report report(settings.folder, "simulations", "discretization", "The error that answers state");
  Table table("simulations-discretization", {{"family", "Family"},
                                             {"way", "Simulation"},
                                             {"paths", "Paths compared"},
                                             {"left_out", "Left out"},
                                             {"median_percent", "Error of the stress, median, %"},
                                             {"p90_percent", "90 % below, %"},
                                             {"worst_percent", "Worst, %"},
                                             {"estimate_percent", "Estimate, median, %"},
                                             {"covered", "Paths that err by less than it"},
                                             {"energy_covered", "The same of the energy"},
                                             {"time", "Time over that before, median"},
                                             {"time_p90", "90 % below"}});
  const StudiedPaths paths = read_paths(file);
  std::map<std::string, int> covered, estimated, total;
  double worst = 0;
  std::vector<double> all_ratios;
  for (const auto& [family, ways_of] : paths) {
    const auto before = ways_of.find("before");
    for (const std::string way : {"before", "estimated", "default"}) {
      const auto found = ways_of.find(way);
      if (found == ways_of.end()) continue;
      std::vector<double> errors, estimates, ratios;
      int left_out = 0, held = 0, energy_held = 0;
      for (const auto& [name, path] : found->second) {
        if (before != ways_of.end()) ratios.push_back(path.seconds / before->second.at(name).seconds);
        if (!path.same_branch || (way != "before" && !path.estimated)) {
          ++left_out;
          continue;
        }
        errors.push_back(percent_of(path.error, path.stress));
        estimates.push_back(percent_of(path.estimate, path.stress));
        held += path.error <= path.estimate ? 1 : 0;
        energy_held += path.energy_error <= path.energy_estimate ? 1 : 0;
      }
      if (errors.empty()) continue;
      const bool says = way != "before";
      if (says) {
        covered[way] += held;
        estimated[way] += static_cast<int>(errors.size());
      }
      if (way == "default") {
        worst = std::max(worst, quantile(errors, 1));
        all_ratios.insert(all_ratios.end(), ratios.begin(), ratios.end());
      }
      table.row({family, way, std::to_string(errors.size()), std::to_string(left_out), number(median(errors)),
                 number(quantile(errors, 0.9)), number(quantile(errors, 1)), says ? number(median(estimates)) : "",
                 says ? std::to_string(held) : "", says ? std::to_string(energy_held) : "",
                 ratios.empty() ? "" : number(median(ratios)), ratios.empty() ? "" : number(quantile(ratios, 0.9))});
    }
  }
  for (const std::string way : {"default", "estimated"}) {
    if (estimated[way] == 0) continue;
    const double share = 100.0 * covered[way] / estimated[way];
    report.target(
        way + ": paths that err by less than the estimate", "at least 90 of 100",
        number(share) + " of 100 (" + std::to_string(covered[way]) + " of " + std::to_string(estimated[way]) + ")",
        share >= 90);
  }
  report.target("default: worst error of the stress", "at most 0.5 %", number(worst) + " %", worst <= 0.5);
  if (!all_ratios.empty())
    report.target("default: time over that of the default before, median", "at most 2", number(median(all_ratios)),
                  median(all_ratios) <= 2);
  if (!all_ratios.empty())
    report.target("default: time over that of the default before, in 90 of 100 paths below", "at most 2",
                  number(quantile(all_ratios, 0.9)), quantile(all_ratios, 0.9) <= 2);
  report.table(table);
  report.text("Every state is in [a file of its own](simulations-discretization-states.csv).");
  std::string done;
  for (const auto& [family, ways_of] : paths)
    done += (done.empty() ? "" : ", ") + family + " " + std::to_string(ways_of.begin()->second.size() / 2);
  report.write(
      "simulation_bench discretization", settings.brief,
      "Random designs under tension to a stretch of 1.1 and compression to 0.95 along a random direction, three states "
      "each, against the mesh 0.35, 0.05 (IH21, IH28 and IH29: 0.5, 0.05), extrapolated. *before* is the mesh 1/2, 0.1 "
      "as it is, an earlier default; *estimated* is the same with its error, as where a request gives the mesh; "
      "*default* is what a request without a mesh gets. Errors and estimates are root mean squares over a path, as "
      "`accuracy.discretization_error`. Paths are left out if they are on another branch or in another patch than the "
      "reference, where beams buckle a little sooner or later, and if they have no estimate. A time includes the "
      "meshing. The run goes on where it was interrupted; designs so far: " +
          done + ".");
}

}  // namespace

void study_discretization(const SimulationSettings& settings) {
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
  std::filesystem::create_directories(settings.folder);
  std::ofstream out(file, std::ios::app);
  if (done.empty())
    out << "family,design,load,way,state,nodes,meshing_s,cpu_s,same_branch,branch,cells,stress,stress_error,"
           "stress_estimate,energy,energy_error,energy_estimate\n";
  for (int design = 0; design < designs; ++design) {
    for (const std::string& family : families) {
      if (done.count(family + "," + std::to_string(design)) > 0) continue;
      RandomStream random("simulation_discretization " + family + " " + std::to_string(design), 1);
      const std::vector<tiling::Structure> structures = random_structures(family, design + 1);
      // All rows of a design are written at once, so that the file contains whole designs.
      std::ostringstream rows;
      study_design(rows, family, design, structures.back(), uniaxial_paths(random), ways(family, settings.brief));
      out << rows.str() << std::flush;
    }
  }
  write_section(settings, file);
}

}  // namespace supple::bench
