// A network and simulations along a parameter that passes a change of topology (thesis 4.4.3, fig. 4.13): the family
// "square", whose inner void vanishes for |p| < 0.0424 and whose outer voids do for |p| > 0.9576.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/dataset/dataset_file.h"
#include "supple/lab/dataset_maker.h"
#include "supple/lab/engine_version.h"
#include "supple/microscale/simulation.h"
#include "supple/neural/uniaxial.h"
#include "supple/tiling/structure.h"
#include "supple/training/model_training.h"

namespace supple::bench {
namespace {

constexpr double load_stretch = 1.05;  ///< of the uniaxial load along x
constexpr double fine_step = 1e-5;
constexpr double void_closes = 0.0424;  ///< half a beam's width: |p| where the inner void does

lab::DatasetOptions data_options(bool brief) {
  lab::DatasetOptions options;
  options.family = "square";
  options.designs = brief ? 24 : 128;
  options.box_margin = 0;  // beyond 1 nothing changes
  // Moderate strains: what is looked at is the way through p = 0, not buckling.
  options.loads.tension_paths = brief ? 1 : 3;
  options.loads.compression_paths = brief ? 1 : 2;
  options.loads.biaxial_paths = brief ? 1 : 2;
  options.loads.max_stretch = 1.1;
  options.loads.min_stretch = 0.92;
  options.loads.max_biaxial_stretch = 1.06;
  options.loads.min_biaxial_stretch = 0.96;
  if (brief) options.simulation.mesh.mesh_size = 1;
  return options;
}

/// Made from simulations the first time; kept in the work folder.
neural::Model trained_model(const std::filesystem::path& folder, bool brief) {
  const auto file = folder / "square.h5";
  if (std::filesystem::exists(file)) return neural::read_model(file);
  const auto data_file = folder / "square-data.h5";
  lab::make_dataset(data_options(brief), data_file);
  training::ModelOptions options;
  options.id = "square";
  options.training.shape.width = brief ? 16 : 48;
  options.training.epochs = brief ? 4 : 120;
  const auto checkpoint = folder / "square.h5.partial";
  const auto trained = training::train_model({dataset::read_dataset(data_file), {}}, data_file.filename().string(),
                                             lab::engine_version(), options, checkpoint, {}, [](const auto&) {});
  neural::write_model(file, trained.model);
  std::filesystem::remove(checkpoint);
  return trained.model;
}

struct Sample {
  double p = 0;
  double energy = 0;  ///< MPa
  double stress = 0;  ///< along the load, MPa
};

Sample simulated(double p, bool brief) {
  microscale::SimulationOptions options;
  options.tolerance = 1e-10;  // what shakes the curve is the mesh
  options.tangents = false;
  if (brief) options.mesh.mesh_size = 1;
  const std::vector<double> parameters{p};
  microscale::Simulator simulator(tiling::make_structure(tiling::family("square"), parameters), options);
  const auto state = simulator.run(microscale::UniaxialLoad{0, {load_stretch}}).states.back();
  return {p, state.energy_density, state.stress[0]};
}

Sample predicted(const neural::Evaluator& evaluator, double p) {
  const auto state = neural::uniaxial_path(evaluator, evaluator.design(std::vector{p}), 0,
                                           std::vector{neural::green_strain_of_stretch(load_stretch)})[0];
  return {p, state.energy_density, state.directional_stress};
}

Shaking steps_along(const std::vector<Sample>& samples, double Sample::*value) {
  std::vector<double> values;
  values.reserve(samples.size());
  for (const auto& s : samples) values.push_back(s.*value);
  return shaking_of(values);
}

}  // namespace

void study_singularity(const NeuralSettings& settings) {
  Report report(settings.folder, "models-singularity", "Models: through a change of topology");
  const auto model = trained_model(work_folder(settings, "singularity"), settings.brief);
  const neural::Evaluator evaluator(model.network);

  Table curves("models-singularity-curves", {{"window", "Window"},
                                             {"source", "Source"},
                                             {"p", "p"},
                                             {"energy", "Energy density, MPa"},
                                             {"stress", "S_xx, MPa"}});
  Table table("models-singularity", {{"window", "Around p ="},
                                     {"source", "Source"},
                                     {"steps", "Steps of 1e-5"},
                                     {"energy_typical", "Energy: typical second difference"},
                                     {"energy_largest", "Largest"},
                                     {"stress_typical", "S_xx: typical second difference"},
                                     {"stress_largest", "Largest"}});
  const auto add = [&](const std::string& window, const std::string& source, const Sample& s) {
    curves.row({window, source, number(s.p, 8), number(s.energy, 12), number(s.stress, 12)});
  };
  // The whole range, and where the inner void closes, coarsely.
  std::vector<double> errors;
  const int coarse = settings.brief ? 5 : 49;
  for (const auto& [window, half_width] : {std::pair{"whole", 1.0}, std::pair{"near", 0.06}}) {
    for (int i = 0; i < coarse; ++i) {
      const double p = half_width * (2.0 * i / (coarse - 1) - 1);
      const auto native = simulated(p, settings.brief);
      const auto network = predicted(evaluator, p);
      errors.push_back(100 * std::abs(network.energy / native.energy - 1));
      add(window, "simulation", native);
      add(window, "network", network);
    }
  }
  // The network in fine steps through all three changes around p = 0; too many for a file.
  const int all_steps = settings.brief ? 200 : 10000;
  std::vector<Sample> through;
  for (int i = 0; i <= all_steps; ++i) through.push_back(predicted(evaluator, fine_step * (i - all_steps / 2)));
  const auto row = [&](const std::string& window, const std::string& source, const std::vector<Sample>& samples) {
    const auto energy = steps_along(samples, &Sample::energy);
    const auto stress = steps_along(samples, &Sample::stress);
    table.row({window, source, std::to_string(samples.size() - 1), number(energy.second), number(energy.second_largest),
               number(stress.second), number(stress.second_largest)});
  };
  row("0, all within 0.05", "network", through);
  double network_largest = 0;
  double native_largest = 0;
  const int n = settings.brief ? 4 : 50;
  for (const double middle : {0.0, void_closes, 1 - void_closes}) {
    std::vector<Sample> native;
    std::vector<Sample> network;
    for (int i = 0; i <= n; ++i) {
      const double p = middle + fine_step * (i - n / 2);
      native.push_back(simulated(p, settings.brief));
      network.push_back(predicted(evaluator, p));
      add(number(middle), "simulation", native.back());
      add(number(middle), "network", network.back());
    }
    row(number(middle), "simulation", native);
    row(number(middle), "network", network);
    network_largest = std::max(network_largest, steps_along(network, &Sample::energy).second_largest);
    native_largest = std::max(native_largest, steps_along(native, &Sample::energy).second_largest);
  }
  const auto& split = *model.design_split;
  report.text("Errors of this network on designs that training has not seen: stress " +
              number(100 * split.gradient.mean) + " % mean and " + number(100 * split.gradient.median) +
              " % median, energy " + number(100 * split.energy.mean) +
              " % mean. On two coarse sweeps its energies differ " + "from fresh simulations by " +
              number(mean(errors)) + " % in the mean, at most " + number(quantile(errors, 1)) +
              " %. The largest second difference of the simulated energies in a window is " +
              number(native_largest / network_largest, 2) + " times that of the network's.");
  report.table(table);
  report.image("models-singularity.svg", "Energy density and stress along p, by simulation and by the network");
  report.text("All values: [CSV](models-singularity-curves.csv).");
  report.data(curves);
  report.write(neural_introduction(
      settings, "singularity",
      "A square of half side |p| in a square cell of half side 1, beams 0.0848 wide: below |p| = 0.0424 the inner void "
      "is closed, above 0.9576 the outer ones are. Energy density and S_xx under a uniaxial stretch of 1.05 along x, "
      "by "
      "simulation, each design meshed anew (tolerance 1e-10), and by a network 48 wide that is trained on " +
          std::to_string(data_options(settings.brief).designs) +
          " simulated designs (stretches 0.92 to 1.1). Second differences are |f(p + h) - 2 f(p) + f(p - h)| over f, h "
          "= 1e-5."));
}

}  // namespace supple::bench
