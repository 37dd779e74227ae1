// Energy density and stress along one parameter in steps of a millionth: how much remeshing shakes them.
#include <algorithm>
#include <cmath>
#include <vector>

#include "measurement.h"
#include "simulation_bench.h"

namespace supple::bench {
namespace {

struct Sample {
  double parameter = 0;
  double energy_density = 0;
  double stress = 0;  ///< along the load
  int nodes = 0;
};

Sample sample(double second_parameter) {
  const tiling::Family& family = tiling::family("IH21");
  const std::vector<double> parameters{family.parameters[0].preset, second_parameter};
  microscale::SimulationOptions options = data_set_options();
  options.tolerance = 1e-10;  // what shakes the curve is the mesh
  options.tangents = false;
  microscale::Simulator simulator(tiling::make_structure(family, parameters), options);
  const microscale::State state = simulator.run(microscale::UniaxialLoad{0, {1.05}}).states.back();
  return {second_parameter, state.energy_density, state.stress[0], static_cast<int>(simulator.mesh().nodes.cols())};
}

struct Line {
  double slope;
  double largest_residual;
};

/// Least squares.
Line fit(const std::vector<Sample>& samples, double Sample::*value) {
  const auto n = static_cast<double>(samples.size());
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const Sample& s : samples) x += s.parameter / n, y += s.*value / n;
  for (const Sample& s : samples) {
    xx += (s.parameter - x) * (s.parameter - x);
    xy += (s.parameter - x) * (s.*value - y);
  }
  Line line{xy / xx, 0};
  for (const Sample& s : samples)
    line.largest_residual = std::max(line.largest_residual, std::abs(s.*value - y - line.slope * (s.parameter - x)));
  return line;
}

/// Share of the steps that go down.
double falling(const std::vector<Sample>& samples, double Sample::*value) {
  int down = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) down += samples[i].*value < samples[i - 1].*value;
  return down / static_cast<double>(samples.size() - 1);
}

}  // namespace

void study_smoothness(const SimulationSettings& settings) {
  const double step = 1e-6;
  const int n = settings.brief ? 5 : 200;
  const double middle = tiling::family("IH21").parameters[1].preset;
  Report report(settings.folder, "simulations-smoothness", "Simulations: noise of the mesh along a parameter");
  std::vector<Sample> samples;
  for (int i = 0; i < n; ++i) samples.push_back(sample(middle + step * (i - n / 2)));

  Table data("simulations-smoothness",
             {{"p2", "p2"}, {"energy_density", "Energy density, MPa"}, {"stress", "S_xx, MPa"}, {"nodes", "Nodes"}});
  for (const Sample& s : samples)
    data.row({number(s.parameter, 10), number(s.energy_density, 13), number(s.stress, 13), std::to_string(s.nodes)});
  Table summary("simulations-smoothness-summary", {{"quantity", "Quantity"},
                                                   {"slope", "Slope of the line through all, MPa"},
                                                   {"trend", "Change over one step, relative"},
                                                   {"residual", "Largest distance from the line, relative"},
                                                   {"falling", "Steps down, %"}});
  for (const auto& [name, value] :
       {std::pair{"energy density", &Sample::energy_density}, std::pair{"S_xx", &Sample::stress}}) {
    const Line line = fit(samples, value);
    const double size = std::abs(samples.front().*value);
    summary.row({name, number(line.slope), number(std::abs(line.slope) * step / size),
                 number(line.largest_residual / size), number(100 * falling(samples, value))});
  }
  report.heading("Along p2 of IH21");
  report.text(
      "The distance from the line, over the change in one step, tells for how many steps the derivative by "
      "differences is lost in the mesh's noise.");
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
