// Curves of directional stress by the network against fresh simulations of designs that no data set holds.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "simulation_bench.h"
#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/microscale/simulation.h"
#include "supple/neural/error_bars.h"
#include "supple/neural/uniaxial.h"
#include "supple/tiling/family.h"
#include "supple/tiling/structure.h"

namespace supple::bench {
namespace {

/// Errors of the thesis's networks, in percent (4.4.3).
constexpr double mean_allowed = 0.475;
constexpr double worst_allowed = 3.57;

/// What the family's data set is made with, on a coarse mesh in a short run; curves need no tangents.
microscale::SimulationOptions options_of(const std::string& family, bool brief) {
  auto options = data_set_options(family);
  if (brief) options.mesh.mesh_size = 1;
  options.tangents = false;
  return options;
}

/// Strains at 25 places from 30 % compression to 50 % tension, rest left out.
std::vector<double> stretches(bool tension) {
  std::vector<double> values;
  for (int i = 0; i < 25; ++i) {
    const double strain = -0.3 + 0.8 * i / 24;
    if (std::abs(strain) > 1e-9 && (strain > 0) == tension) values.push_back(1 + strain);
  }
  if (!tension) std::reverse(values.begin(), values.end());
  return values;
}

/// The simulation pulls along a direction of space, F^T d = s d with the rest of F free: its stress is uniaxial, S =
/// sigma m m^T, along the direction m of the material that F^-1 d has. The thesis's problem for networks (4.9c) gives
/// m^T E m and leaves the other strains free: the same state, asked for along m.
struct MaterialLoad {
  double direction = 0;
  double green_strain = 0;
  double stress = 0;  ///< m^T S m
};

MaterialLoad material_load(const microscale::State& state, double direction) {
  const Eigen::Vector2d d(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d m = state.deformation_gradient.partialPivLu().solve(d).normalized();
  const auto along = [&](const Eigen::Vector3d& t) {
    return m[0] * m[0] * t[0] + m[1] * m[1] * t[1] + 2 * m[0] * m[1] * t[2];
  };
  return {std::atan2(m[1], m[0]), along(state.green_strain), along(state.stress)};
}

/// A state of a simulated curve.
struct Place {
  double stretch = 1;
  MaterialLoad load;
};
struct Curve {
  std::vector<double> parameters;
  double direction = 0;
  std::vector<Place> places;
  double seconds = 0;  ///< CPU time of one thread
};

Curve simulate(microscale::Simulator& simulator, std::vector<double> parameters, double direction) {
  Curve curve{std::move(parameters), direction, {}, 0};
  for (const bool tension : {false, true}) {
    const auto load = stretches(tension);
    microscale::SimulationResult native;
    curve.seconds += cpu_time([&] { native = simulator.run(microscale::UniaxialLoad{direction, load}); });
    for (std::size_t i = 0; i < native.states.size(); ++i) {
      if (native.states[i].stopped != microscale::Stop::converged) break;
      curve.places.push_back({load[i], material_load(native.states[i], direction)});
    }
  }
  return curve;
}

/// Curves that earlier runs have simulated, by the number of their draw, a line each. They do not depend on the models;
/// a change of the simulation asks for the work folder to be removed.
class KeptCurves {
 public:
  explicit KeptCurves(std::filesystem::path file) : file_(std::move(file)) {
    std::ifstream in(file_);
    for (std::string line; std::getline(in, line);) {
      std::istringstream text(line);
      int draw = 0;
      Curve curve;
      std::size_t places = 0;
      if (!(text >> draw >> curve.seconds >> places)) continue;
      curve.places.resize(places);
      for (auto& [stretch, load] : curve.places) text >> stretch >> load.direction >> load.green_strain >> load.stress;
      if (text) curves_[draw] = std::move(curve);
    }
  }

  const Curve* find(int draw) const {
    const auto found = curves_.find(draw);
    return found == curves_.end() ? nullptr : &found->second;
  }

  void keep(int draw, const Curve& curve) {
    std::ofstream out(file_, std::ios::app);
    out.precision(17);
    out << draw << ' ' << curve.seconds << ' ' << curve.places.size();
    for (const auto& [stretch, load] : curve.places)
      out << ' ' << stretch << ' ' << load.direction << ' ' << load.green_strain << ' ' << load.stress;
    out << '\n';
  }

 private:
  std::filesystem::path file_;
  std::map<int, Curve> curves_;
};

std::vector<Curve> simulated_curves(const NeuralSettings& settings, const tiling::Family& family, int wanted) {
  KeptCurves kept(work_folder(settings, "uniaxial") / (family.id + ".txt"));
  RandomStream stream("uniaxial study " + family.id, 1);
  std::vector<Curve> curves;
  for (int draw = 0; static_cast<int>(curves.size()) < wanted; ++draw) {
    std::vector<double> parameters;
    for (const auto& parameter : family.parameters)
      parameters.push_back(stream.uniform(parameter.lower, parameter.upper));
    const double direction = stream.uniform(0, std::numbers::pi);
    if (const auto* known = kept.find(draw)) {
      curves.push_back(*known);
      curves.back().parameters = parameters;
      curves.back().direction = direction;
      continue;
    }
    std::optional<microscale::Simulator> simulator;
    try {
      simulator.emplace(tiling::make_structure(family, parameters), options_of(family.id, settings.brief));
    } catch (const Error&) {
      continue;  // no structure at these parameters
    }
    curves.push_back(simulate(*simulator, parameters, direction));
    kept.keep(draw, curves.back());
  }
  return curves;
}

}  // namespace

void study_uniaxial(const NeuralSettings& settings) {
  Report report(settings.folder, "models-uniaxial", "Models: uniaxial curves against fresh simulations");
  Table table("models-uniaxial", {{"family", "Family"},
                                  {"designs", "Designs"},
                                  {"points", "Points"},
                                  {"mean_percent", "Mean error %"},
                                  {"median_percent", "Median %"},
                                  {"percentile_99", "99th percentile %"},
                                  {"worst_percent", "Worst %"},
                                  {"beyond_percent", "Points beyond 3.57 %, %"},
                                  {"curve_mean", "Mean, of the curve's largest %"},
                                  {"curve_worst", "Worst, of the curve's largest %"},
                                  {"network_ms", "Network, ms a state"},
                                  {"native_ms", "Simulation, ms a state"},
                                  {"not_converged", "Not converged"}});
  Table points("models-uniaxial-points", {{"family", "Family"},
                                          {"design", "Design"},
                                          {"direction", "Direction"},
                                          {"stretch", "Stretch"},
                                          {"native", "Simulated stress"},
                                          {"network", "Predicted stress"},
                                          {"error_bar", "Error bar of it"},
                                          {"in_range", "In range"}});
  for (const auto& model : models_of(settings)) {
    const auto& family = tiling::family(model.family);
    const neural::Evaluator evaluator(model.network);
    std::vector<double> errors;
    std::vector<double> curve_errors;
    double network_seconds = 0;
    double native_seconds = 0;
    int states = 0;
    int failed = 0;
    const int wanted = settings.brief ? 1 : settings.designs_or(50);
    const auto curves = simulated_curves(settings, family, wanted);
    for (std::size_t design = 0; design < curves.size(); ++design) {
      const auto& curve = curves[design];
      const auto prepared = evaluator.design(curve.parameters);
      const neural::ErrorBars bars(model, evaluator, prepared, curve.parameters, true);
      native_seconds += curve.seconds;
      double largest = 0;
      for (const auto& place : curve.places) largest = std::max(largest, std::abs(place.load.stress));
      for (const auto& [stretch, load] : curve.places) {
        std::vector<neural::UniaxialState> predicted;
        network_seconds += cpu_time([&] {
          predicted = neural::uniaxial_path(evaluator, prepared, load.direction, std::vector{load.green_strain});
        });
        ++states;
        const auto& state = predicted[0];
        if (!state.converged) ++failed;
        const auto trust =
            bars.uniaxial(neural::Quantity::stress, neural::UniaxialFrame(load.direction), load.green_strain,
                          state.strain, {state.energy_density, state.stress, state.tangent});
        errors.push_back(100 * std::abs(state.directional_stress / load.stress - 1));
        curve_errors.push_back(100 * std::abs(state.directional_stress - load.stress) / largest);
        points.row({model.family, std::to_string(design), number(curve.direction, 6), number(stretch, 6),
                    number(load.stress, 6), number(state.directional_stress, 6),
                    trust.error ? number(*trust.error * std::abs(state.directional_stress), 3) : "",
                    trust.in_range ? "1" : "0"});
      }
    }
    const double network_ms = 1e3 * network_seconds / states;
    const auto beyond = std::count_if(errors.begin(), errors.end(), [](double error) { return error > worst_allowed; });
    table.row({model.family, std::to_string(wanted), std::to_string(states), number(mean(errors)),
               number(median(errors)), number(quantile(errors, 0.99)), number(quantile(errors, 1)),
               number(100 * static_cast<double>(beyond) / states), number(mean(curve_errors)),
               number(quantile(curve_errors, 1)), number(network_ms), number(1e3 * native_seconds / states),
               std::to_string(failed)});
    report.target(model.family + ": mean error of the directional stress", "0.475 %", number(mean(errors)) + " %",
                  mean(errors) <= mean_allowed);
    report.target(model.family + ": worst error", "3.57 %", number(quantile(errors, 1)) + " %",
                  quantile(errors, 1) <= worst_allowed);
    report.target(model.family + ": an equilibrium by the network", "2 ms", number(network_ms) + " ms",
                  network_ms <= 2);
  }
  report.table(table);
  report.data(points);
  report.write(neural_introduction(
      settings, "uniaxial",
      "Random designs and directions that no data set holds, strains at 24 places from 30 % "
      "compression to 50 % tension, simulated with the mesh of the family's data set. "
      "The simulation pulls along a direction of space; its stress is uniaxial along a direction m of the material, "
      "along which the network is asked for the same m^T E m, each state from rest. "
      "Errors are |s - s*| / |s*| of the directional stress s = m^T S m at each place, as the "
      "thesis's relative error; beside it the same difference over the largest |s*| of its curve. "
      "CPU time, one thread; simulations that an earlier run has kept in the work folder have the time they took "
      "then."));
}

}  // namespace supple::bench
