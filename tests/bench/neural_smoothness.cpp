// Energy and stress at a fixed strain along a design parameter: simulations zigzag with their meshes, networks do not
// (thesis 4.4.3, fig. 4.12).
#include <cmath>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "simulation_bench.h"
#include "supple/microscale/simulation.h"
#include "supple/neural/uniaxial.h"

namespace supple::bench {
namespace {

constexpr double green_strain = 0.05;  ///< along x

struct ParameterCurve {
  std::vector<double> energy;  ///< MPa
  std::vector<double> stress;  ///< S_xx, MPa
};

}  // namespace

void study_smoothness(const NeuralSettings& settings) {
  Report report(settings.folder, "models-smoothness", "Models: the network's smooth curve against the mesh's zigzag");
  Table table("models-smoothness", {{"family", "Family"},
                                    {"step", "Step of p1"},
                                    {"quantity", "Quantity"},
                                    {"source", "Source"},
                                    {"typical", "Typical change over a step"},
                                    {"second", "Typical second difference"},
                                    {"second_largest", "Largest second difference"},
                                    {"against", "Steps against the trend"},
                                    {"steps", "Of"}});
  Table curves("models-smoothness-curves", {{"family", "Family"},
                                            {"step", "Step"},
                                            {"p1", "p1"},
                                            {"native_energy", "Simulated energy, MPa"},
                                            {"network_energy", "Predicted energy, MPa"},
                                            {"native_stress", "Simulated S_xx, MPa"},
                                            {"network_stress", "Predicted S_xx, MPa"}});
  const int n = settings.brief ? 4 : 60;
  for (const auto& model : models_of(settings)) {
    const auto& family = tiling::family(model.family);
    const neural::Evaluator evaluator(model.network);
    auto options = data_set_options(model.family);
    options.tolerance = 1e-10;  // what shakes the curve is the mesh
    options.tangents = false;
    if (settings.brief) options.mesh.mesh_size = 1;
    std::vector<double> parameters;
    for (const auto& parameter : family.parameters) parameters.push_back(0.5 * (parameter.lower + parameter.upper));
    const double middle = parameters[0];
    // One strain for all designs and for both sides: the middle design's equilibrium.
    const Eigen::Vector3d e =
        neural::uniaxial_path(evaluator, evaluator.design(parameters), 0, std::vector{green_strain})[0].strain;
    const microscale::GreenStrainLoad load{{{e[0], e[1], 0.5 * e[2]}}};
    for (const double share : {1e-3, 1e-6}) {
      const double step = share * (family.parameters[0].upper - family.parameters[0].lower);
      ParameterCurve native;
      ParameterCurve network;
      for (int i = 0; i <= n; ++i) {
        parameters[0] = middle + step * (i - n / 2);
        microscale::Simulator simulator(tiling::make_structure(family, parameters), options);
        const auto state = simulator.run(load).states.back();
        const auto answer = evaluator.evaluate(evaluator.design(parameters), e, neural::Order::stress);
        native.energy.push_back(state.energy_density);
        native.stress.push_back(state.stress[0]);
        network.energy.push_back(answer.energy_density[0]);
        network.stress.push_back(answer.stress(0, 0));
        curves.row({model.family, number(step), number(parameters[0], 10), number(native.energy.back(), 12),
                    number(network.energy.back(), 12), number(native.stress.back(), 12),
                    number(network.stress.back(), 12)});
      }
      for (const auto& [quantity, values] :
           {std::pair{"energy", &ParameterCurve::energy}, std::pair{"S_xx", &ParameterCurve::stress}}) {
        for (const auto& [source, curve] : {std::pair{"simulation", &native}, std::pair{"network", &network}}) {
          const auto steps = shaking_of(curve->*values);
          table.row({model.family, number(step), quantity, source, number(steps.typical), number(steps.second),
                     number(steps.second_largest), std::to_string(steps.against), std::to_string(n)});
        }
      }
    }
  }
  report.table(table);
  report.image("models-smoothness.svg", "Energy density and stress along p1, by simulation and by the network");
  report.text("All values: [CSV](models-smoothness-curves.csv).");
  report.data(curves);
  report.write(neural_introduction(
      settings, "smoothness",
      "Energy density and S_xx at one Green strain, the network's uniaxial equilibrium at E_xx = 0.05 of the design in "
      "the middle of the family's box, along the first parameter in steps of a thousandth and of a millionth of its "
      "range. Each simulated design is meshed anew as for data sets, tolerance 1e-10. Changes and second differences "
      "are over the curve's median value."));
}

}  // namespace supple::bench
