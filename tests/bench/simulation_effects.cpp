// What contact and the check for buckling over 2x2 cells cost, and what leaving them out changes.
#include <algorithm>
#include <vector>

#include "measurement.h"
#include "simulation_bench.h"

namespace supple::bench {
namespace {

using microscale::BiaxialLoad;
using microscale::Load;
using microscale::Simulator;
using microscale::State;
using microscale::Switch;
using microscale::UniaxialLoad;

std::vector<Load> loads() {
  return {UniaxialLoad{0, {1.05, 1.1}}, UniaxialLoad{0.7, {0.98, 0.95, 0.92}},
          BiaxialLoad{1.9, {{0.99, 0.99}, {0.97, 0.97}, {0.95, 0.95}}}};
}

/// The effects that a run forces on or off.
struct Variant {
  Switch contact = Switch::automatic;
  Switch patch = Switch::automatic;
};

struct Outcome {
  std::vector<std::vector<State>> paths;
  double cpu_seconds = 0;
  int states = 0;
  double milliseconds() const { return 1e3 * cpu_seconds / std::max(1, states); }
};

Outcome run(const std::string& family, const std::vector<tiling::PeriodicMesh>& meshes, const Variant& variant) {
  Outcome outcome;
  for (const tiling::PeriodicMesh& mesh : meshes) {
    microscale::SimulationOptions options = data_set_options(family);
    options.contact = variant.contact;
    options.patch = variant.patch;
    Simulator simulator(mesh, options);
    for (const Load& load : loads()) {
      TimedPath path = run_timed(simulator, load);
      outcome.cpu_seconds += path.cpu_seconds;
      outcome.states += static_cast<int>(path.result.states.size());
      outcome.paths.push_back(std::move(path.result.states));
    }
  }
  return outcome;
}

struct Difference {
  std::vector<double> alike;      ///< errors of stress in states in which the automatic run stayed with one cell
  std::vector<double> different;  ///< errors of stress in states that needed two by two cells
};

/// Differences in the states that both reached.
Difference differences(const Outcome& outcome, const Outcome& automatic) {
  Difference difference;
  for (std::size_t p = 0; p < automatic.paths.size(); ++p) {
    const std::size_t n = std::min(automatic.paths[p].size(), outcome.paths[p].size());
    for (std::size_t i = 0; i < n; ++i) {
      const State &state = outcome.paths[p][i], &reference = automatic.paths[p][i];
      if (state.stopped != microscale::Stop::converged || reference.stopped != microscale::Stop::converged) continue;
      (reference.cells == 2 ? difference.different : difference.alike).push_back(stress_error(state, reference));
    }
  }
  return difference;
}

std::string difference_percent(const std::vector<double>& errors, double q) {
  return errors.empty() ? "none" : number(100 * quantile(errors, q), 2);
}

}  // namespace

void study_effects(const SimulationSettings& settings) {
  const std::vector<std::string> families = settings.brief ? std::vector<std::string>{"IH01"} : published_families();
  const int designs = settings.designs_or(settings.brief ? 1 : 4);
  Report report(settings.folder, "simulations", "effects", "What effects cost and change");
  Table costs("simulations-effects-cost", {{"family", "Family"},
                                           {"states", "States"},
                                           {"touching", "In contact"},
                                           {"automatic_ms", "Automatic, ms per state"},
                                           {"no_contact_ms", "Contact off"},
                                           {"one_cell_ms", "2x2 off"},
                                           {"four_cells_ms", "2x2 throughout"}});
  Table cells("simulations-effects-cells", {{"family", "Family"},
                                            {"one", "States of one cell"},
                                            {"one_worst", "2x2 throughout differs there by at most, %"},
                                            {"four", "States that need 2x2"},
                                            {"four_median", "One cell is off there by, median, %"},
                                            {"four_worst", "Worst, %"}});
  for (const std::string& family : families) {
    std::vector<tiling::PeriodicMesh> meshes;
    for (const tiling::Structure& structure : random_structures(family, designs))
      meshes.push_back(tiling::mesh_structure(structure, data_set_options(family).mesh));
    const Outcome automatic = run(family, meshes, {});
    const Outcome no_contact = run(family, meshes, {Switch::off, Switch::automatic});
    const Outcome one_cell = run(family, meshes, {Switch::automatic, Switch::off});
    const Outcome four_cells = run(family, meshes, {Switch::automatic, Switch::on});
    int touching = 0;
    for (const std::vector<State>& path : automatic.paths)
      touching +=
          static_cast<int>(std::count_if(path.begin(), path.end(), [](const State& s) { return s.contacts > 0; }));
    costs.row({family, std::to_string(automatic.states), std::to_string(touching), number(automatic.milliseconds()),
               number(no_contact.milliseconds()), number(one_cell.milliseconds()), number(four_cells.milliseconds())});
    const Difference off = differences(one_cell, automatic), on = differences(four_cells, automatic);
    cells.row({family, std::to_string(on.alike.size()), difference_percent(on.alike, 1),
               std::to_string(off.different.size()), difference_percent(off.different, 0.5),
               difference_percent(off.different, 1)});
  }
  report.heading("Cost");
  report.table(costs);
  report.heading("One cell against two by two");
  report.text(
      "Automatic: one cell until its equilibrium is unstable against a mode that alternates from cell to cell, then "
      "two "
      "by two. The columns compare stress with runs that use two by two cells from the start, where automatic stayed "
      "with one, and with runs that never do, where automatic left it. A difference in the former means that the two "
      "took different branches.");
  report.table(cells);
  report.write("simulation_bench effects", settings.brief,
               std::to_string(designs) +
                   " random designs per family on the data sets' mesh, under uniaxial tension to 1.1, uniaxial "
                   "compression to 0.92 and equal biaxial compression to 0.95; eight states. Meshing does not count.");
}

}  // namespace supple::bench
