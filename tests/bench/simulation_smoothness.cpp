// Energy density and stress along one parameter in steps of a millionth: how much remeshing shakes them.
#include <cmath>
#include <utility>
#include <vector>

#include "measurement.h"
#include "simulation_bench.h"

namespace supple::bench {
namespace {

struct ParameterSample {
  double parameter = 0;
  double energy_density = 0;
  double stress = 0;  ///< along the load
  int nodes = 0;
};

ParameterSample sample(double second_parameter) {
  const tiling::Family& family = tiling::family("IH21");
  const std::vector<double> parameters{family.parameters[0].preset, second_parameter};
  microscale::SimulationOptions options;
  options.tolerance = 1e-10;  // what shakes the curve is the mesh
  options.tangents = false;
  microscale::Simulator simulator(tiling::make_structure(family, parameters), options);
  const microscale::State state = simulator.run(microscale::UniaxialLoad{0, {1.05}}).states.back();
  return {second_parameter, state.energy_density, state.stress[0], static_cast<int>(simulator.mesh().nodes.cols())};
}

struct Steps {
  double typical = 0;  ///< median size, relative to the value
  double largest = 0;  ///< relative to the value
  int jumps = 0;       ///< beyond five times the typical size
  int against = 0;     ///< against the direction of most
};

Steps steps_of(const std::vector<ParameterSample>& samples, double ParameterSample::*value) {
  std::vector<double> changes, sizes;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    changes.push_back(samples[i].*value / (samples[i - 1].*value) - 1);
    sizes.push_back(std::abs(changes.back()));
  }
  const double trend = median(changes);
  Steps steps{median(sizes), quantile(sizes, 1)};
  for (const double change : changes) {
    steps.jumps += std::abs(change) > 5 * steps.typical;
    steps.against += change * trend < 0;
  }
  return steps;
}

}  // namespace

void study_smoothness(const SimulationSettings& settings) {
  const double step = 1e-6;
  const int n = settings.brief ? 5 : 200;
  const double middle = tiling::family("IH21").parameters[1].preset;
  Report report(settings.folder, "simulations-smoothness", "Simulations: noise of the mesh along a parameter");
  std::vector<ParameterSample> samples;
  for (int i = 0; i < n; ++i) samples.push_back(sample(middle + step * (i - n / 2)));

  Table data("simulations-smoothness",
             {{"p2", "p2"}, {"energy_density", "Energy density, MPa"}, {"stress", "S_xx, MPa"}, {"nodes", "Nodes"}});
  for (const ParameterSample& s : samples)
    data.row({number(s.parameter, 10), number(s.energy_density, 13), number(s.stress, 13), std::to_string(s.nodes)});
  Table summary("simulations-smoothness-summary", {{"quantity", "Quantity"},
                                                   {"typical", "Typical change over one step, relative"},
                                                   {"largest", "Largest, relative"},
                                                   {"jumps", "Steps beyond five times the typical"},
                                                   {"against", "Steps against the trend"}});
  for (const auto& [name, value] :
       {std::pair{"energy density", &ParameterSample::energy_density}, std::pair{"S_xx", &ParameterSample::stress}}) {
    const Steps steps = steps_of(samples, value);
    summary.row({name, number(steps.typical), number(steps.largest), std::to_string(steps.jumps),
                 std::to_string(steps.against)});
  }
  report.heading("Along p2 of IH21");
  report.text(
      "As long as meshes keep their topology both curves are smooth. Where it changes they jump; the largest jump over "
      "the typical change tells over how many steps a difference must reach before the derivative shows.");
  report.table(summary);
  report.image("simulations-smoothness.svg", "Energy density and stress along the parameter");
  report.text("All values: [CSV](simulations-smoothness.csv).");
  report.data(data);
  report.write(simulation_introduction(settings, "smoothness",
                                       "IH21 at its default p1, p2 around its default in " + std::to_string(n) +
                                           " steps of 1e-6, each design meshed anew as for data sets; uniaxial tension "
                                           "to 1.05 along x, tolerance 1e-10."));
}

}  // namespace supple::bench
