// Time and memory of a sheet against the number of its crossings.
#include <algorithm>
#include <vector>

#include "measurement.h"
#include "weave_bench.h"

namespace supple::bench {
namespace {

using weave::Connection;
using weave::EquilibriumOptions;
using weave::Switch;

/// A way to load sheets of every size.
struct SizeScene {
  std::string name;
  Connection connection;
  Shear shear;
  double amount;
  Switch out_of_plane;
  std::vector<int> sizes;  ///< strands along a side
};

std::vector<SizeScene> size_scenes(const WeaveSettings& settings) {
  const std::vector<int> largest{5, 10, 20, 30, 50, 70, 100};
  // What leaves the plane, or slides for long, needs more iterations the larger it is.
  const std::vector<int> large{5, 10, 20, 30, 50};
  const std::vector<int> medium{5, 10, 20, 30};
  std::vector<SizeScene> all{
      {"fused, in the plane", Connection::fused, Shear::sinking, 0.05, Switch::off, largest},
      {"fused, automatic", Connection::fused, Shear::sinking, 0.05, Switch::automatic, large},
      {"sliding, automatic", Connection::slides_x, Shear::sinking, 0.3, Switch::automatic, largest},
      {"sliding, diagonal", Connection::slides_x, Shear::diagonal, 0.1, Switch::automatic, medium}};
  if (settings.brief)
    for (SizeScene& scene : all) scene.sizes = {3, 5};
  return all;
}

}  // namespace

void study_weave_size(const WeaveSettings& settings) {
  Report report(settings.folder, "weaves-size", "Weaves: cost against the size of a sheet");
  Table table("weaves-size", {{"scene", "Sheet"},
                              {"side", "Strands along a side"},
                              {"crossings", "Crossings"},
                              {"unknowns", "Unknowns"},
                              {"iterations", "Newton iterations"},
                              {"cpu_s", "CPU s"},
                              {"ms_per_iteration", "ms per iteration"},
                              {"mb", "Memory, MB"},
                              {"out_of_plane", "Left the plane"},
                              {"reached", "Reached"}});
  Table fits("weaves-size-exponents", {{"scene", "Sheet"},
                                       {"time", "Exponent of CPU time"},
                                       {"per_iteration", "Of an iteration's"},
                                       {"memory", "Of memory"},
                                       {"kb_per_crossing", "KB per crossing, largest"}});
  for (const SizeScene& scene : size_scenes(settings)) {
    std::vector<double> crossings, seconds, per_iteration, memory;
    for (const int n : scene.sizes) {
      const LoadedSheet sheet = sheared_sheet(n, scene.connection, scene.shear, scene.amount);
      EquilibriumOptions options;
      options.out_of_plane = scene.out_of_plane;
      reset_peak_memory();
      const auto before = static_cast<double>(resident_bytes());
      const TimedSheet run = run_timed(sheet.weave, sheet.load, options);
      const double used = static_cast<double>(peak_resident_bytes()) - before;
      const int iterations = std::max(1, iterations_of(run.result));
      table.row({scene.name, std::to_string(n), count(n * n), count(run.result.unknowns), std::to_string(iterations),
                 number(run.cpu_seconds), number(1e3 * run.cpu_seconds / iterations), number(1e-6 * used),
                 run.result.states.back().out_of_plane ? "yes" : "no",
                 converged(run.result) ? "yes" : "up to " + number(run.result.states.back().share)});
      // Small sheets' memory is pages that the process has already.
      if (n < 10 && !settings.brief) continue;
      crossings.push_back(n * n);
      seconds.push_back(run.cpu_seconds);
      per_iteration.push_back(run.cpu_seconds / iterations);
      memory.push_back(std::max(used, 1.0));
    }
    fits.row({scene.name, number(fitted_exponent(crossings, seconds), 2),
              number(fitted_exponent(crossings, per_iteration), 2), number(fitted_exponent(crossings, memory), 2),
              number(1e-3 * memory.back() / crossings.back())});
  }
  report.heading("Sheets");
  report.image("weaves-size.svg", "CPU time and memory against the number of crossings");
  report.table(table);
  report.heading("Exponents");
  report.text("Of powers of the number of crossings, by least squares of the logarithms.");
  report.table(fits);
  report.write(weave_introduction(
      settings, "size",
      "Square sheets of straight strands, " + number(sheet_pitch, 2) +
          " mm apart, at the default accuracy. Held along the lowest strand, the highest one moved aside and free to "
          "sink: by 5 % of their distance where crossings are fused, by 30 % where they slide along x. *Diagonal*: "
          "held "
          "at one corner, the opposite corner drawn towards it by 10 % of the side in x and in y. One state, one "
          "thread. Memory is the growth of the process's resident memory at its peak, CPU time that of the whole path, "
          "building the model and the look for modes out of the plane included."));
}

}  // namespace supple::bench
