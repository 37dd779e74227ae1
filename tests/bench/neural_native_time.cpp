// Time of a uniaxial equilibrium by the network and by a simulation, over the strain [Thesis, sec. 4.4.3, fig. 4.11].
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "simulation_bench.h"
#include "supple/base/random.h"
#include "supple/microscale/simulation.h"
#include "supple/neural/uniaxial.h"

namespace supple::bench {
namespace {

struct Times {
  std::vector<double> network;  ///< ms of each design and direction
  std::vector<double> native;
};

std::vector<double> strains_of(bool brief) {
  if (brief) return {-0.02, 0.05};
  std::vector<double> strains;
  for (int i = 0; i <= 16; ++i)
    if (const double strain = -0.3 + 0.05 * i; std::abs(strain) > 1e-9) strains.push_back(strain);
  return strains;
}

}  // namespace

void study_native_time(const NeuralSettings& settings) {
  Report report(settings.folder, "models", "native-time", "Time of an equilibrium, beside simulations");
  Table table("models-native-time", {{"family", "Family"},
                                     {"strain", "Strain"},
                                     {"equilibria", "Equilibria"},
                                     {"network_ms", "Network, median ms"},
                                     {"network_worst", "Worst"},
                                     {"native_ms", "Simulation, median ms"},
                                     {"native_worst", "Worst"},
                                     {"ratio", "Ratio of medians"}});
  Table summary("models-native-time-summary", {{"family", "Family"},
                                               {"width", "Width"},
                                               {"unknowns", "Unknowns of a cell's mesh, mean"},
                                               {"network_ms", "Network, mean ms"},
                                               {"network_worst", "Worst"},
                                               {"native_ms", "Simulation, mean ms"},
                                               {"native_worst", "Worst"},
                                               {"ratio", "Ratio of means"},
                                               {"failed", "Simulations that stopped early"}});
  const int wanted = settings.brief ? 1 : settings.designs_or(3);
  for (const auto& model : models_of(settings)) {
    const neural::Evaluator evaluator(model.network);
    auto options = data_set_options(model.family);
    options.tangents = false;
    if (settings.brief) options.mesh.mesh_size = 1;
    std::map<double, Times> times;
    std::vector<double> unknowns;
    int failed = 0;
    RandomStream stream("native time " + model.family, 1);
    for (const auto& structure : random_structures(model.family, wanted)) {
      microscale::Simulator simulator(structure, options);
      unknowns.push_back(2.0 * static_cast<double>(simulator.mesh().nodes.cols()));
      const double direction = stream.uniform(0, std::numbers::pi);
      const auto design = evaluator.design(structure.parameters);
      for (const double strain : strains_of(settings.brief)) {
        const double stretch = 1 + strain;
        // Each state is computed from rest, as for a request; meshing is not counted.
        const auto native = run_timed(simulator, microscale::UniaxialLoad{direction, {stretch}});
        if (native.result.states.back().stopped != microscale::Stop::converged) {
          ++failed;
          continue;
        }
        const std::vector<double> green{neural::green_strain_of_stretch(stretch)};
        const int repetitions = 5;
        const double network = cpu_time([&] {
                                 for (int i = 0; i < repetitions; ++i)
                                   (void)neural::uniaxial_path(evaluator, design, direction, green);
                               }) /
                               repetitions;
        times[strain].network.push_back(1e3 * network);
        times[strain].native.push_back(1e3 * native.cpu_seconds);
      }
    }
    Times all;
    for (const auto& [strain, t] : times) {
      table.row({model.family, number(strain), std::to_string(t.native.size()), number(median(t.network)),
                 number(quantile(t.network, 1)), number(median(t.native)), number(quantile(t.native, 1)),
                 number(median(t.native) / median(t.network))});
      all.network.insert(all.network.end(), t.network.begin(), t.network.end());
      all.native.insert(all.native.end(), t.native.begin(), t.native.end());
    }
    summary.row({model.family, std::to_string(model.network.shape.width), count(mean(unknowns)),
                 number(mean(all.network)), number(quantile(all.network, 1)), number(mean(all.native)),
                 number(quantile(all.native, 1)), number(mean(all.native) / mean(all.network)),
                 std::to_string(failed)});
    report.target(model.family + ": worst equilibrium by the network", "2 ms", number(quantile(all.network, 1)) + " ms",
                  quantile(all.network, 1) <= 2);
  }
  report.table(summary);
  report.image("models-native-time.svg", "Milliseconds of one equilibrium over the strain");
  report.data(table);
  report.write(settings.command("native-time"), settings.brief,
               "Uniaxial equilibria of " + std::to_string(wanted) +
                   " random designs of each family, a random direction each, at strains from 30 % compression to 50 % "
                   "tension. Each is asked for alone, from rest: the simulation goes there in load steps of at most "
                   "0.05 on the mesh of the family's data set, contact, buckling and two-by-two patches where the "
                   "state calls for them; meshing and what depends on the design alone are not counted. CPU time, one "
                   "thread. Times by strain are in [models-native-time.csv](models-native-time.csv). The thesis "
                   "reports 77 ms by network and up to 148 s by simulation.");
}

}  // namespace supple::bench
