// On which equilibrium a path ends: energy and time against the number of load steps.
#include <algorithm>
#include <limits>

#include "measurement.h"
#include "weave_bench.h"

namespace supple::bench {
namespace {

using weave::DirectionalResponse;
using weave::Stop;

/// An equilibrium of more energy than this times the least that any run found is another one.
constexpr double same_equilibrium = 1.01;

}  // namespace

void study_weave_paths(const WeaveSettings& settings) {
  const int directions = settings.brief ? 3 : 48;
  const std::vector<int> steps = settings.brief ? std::vector<int>{1, 4} : std::vector<int>{1, 2, 4, 8, 16};
  const std::vector<std::string> names =
      settings.brief ? std::vector<std::string>{"squares, type 2"}
                     : std::vector<std::string>{"squares, type 1", "squares, type 2", "squares, type 3",
                                                "squares, type 4", "circles, sliding"};
  Report report(settings.folder, "weaves-paths", "Weaves: load steps, and the equilibrium that a path ends on");
  Table table("weaves-paths", {{"cell", "Cell"},
                               {"strain", "Strain"},
                               {"load_steps", "Load steps"},
                               {"ms", "ms per direction"},
                               {"iterations", "Newton iterations per direction"},
                               {"other", "Directions on another equilibrium"},
                               {"worst", "Largest energy over the least"},
                               {"out_of_plane", "Out of the plane"},
                               {"unreached", "Not reached"}});
  for (const std::string& name : names) {
    const weave::Weave cell = cell_named(name).weave;
    for (const double strain : {0.1, 0.3}) {
      std::vector<TimedCell> runs;
      std::vector<double> least(static_cast<std::size_t>(directions), std::numeric_limits<double>::infinity());
      for (const int n : steps) {
        runs.push_back(run_timed(cell, uniaxial(strain, directions, {.load_steps = n})));
        for (std::size_t i = 0; i < least.size(); ++i) {
          const weave::CellState& state = runs.back().result[i].state;
          if (state.stopped == Stop::converged) least[i] = std::min(least[i], state.energy_density);
        }
      }
      // Sliding that costs nothing has energies that are all regularizer: these count as alike.
      const double negligible = 1e-6 * quantile(least, 1);
      for (std::size_t k = 0; k < steps.size(); ++k) {
        int other = 0, out_of_plane = 0, unreached = 0;
        double worst = 1, iterations = 0;
        for (std::size_t i = 0; i < least.size(); ++i) {
          const DirectionalResponse& response = runs[k].result[i];
          iterations += response.state.iterations;
          out_of_plane += response.state.out_of_plane;
          unreached += response.state.stopped != Stop::converged;
          if (response.state.stopped != Stop::converged) continue;
          const double ratio = (response.state.energy_density + negligible) / (least[i] + negligible);
          worst = std::max(worst, ratio);
          other += ratio > same_equilibrium;
        }
        table.row({name, number(strain, 1), std::to_string(steps[k]), number(1e3 * runs[k].cpu_seconds / directions),
                   number(iterations / directions), std::to_string(other), number(worst), std::to_string(out_of_plane),
                   std::to_string(unreached)});
      }
    }
  }
  report.image("weaves-paths.svg", "Directions on another equilibrium, and time, against load steps");
  report.table(table);
  report.write(weave_introduction(
      settings, "paths",
      "Each equilibrium is stable and converged; a weave under large strain has several, and in long steps a path can "
      "come to another one than that which grows out of rest. Energies of " +
          std::to_string(directions) +
          " directions are compared with the least that any number of load steps (`accuracy.load_steps`) led to; more "
          "than 1 % above it counts as another equilibrium. Times are CPU times."));
}

}  // namespace supple::bench
