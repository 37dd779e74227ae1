// Curves of directional stress by the network against fresh simulations of designs that no data set holds.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/neural/uniaxial.h"
#include "supple/tiling/family.h"
#include "uniaxial_curves.h"

namespace supple::bench {
namespace {

/// Mean error of the thesis's networks, in per cent (4.4.3).
constexpr double mean_allowed = 0.475;

}  // namespace

void study_uniaxial(const NeuralSettings& settings) {
  Report report(settings.folder, "models", "uniaxial", "Error of uniaxial curves, against fresh simulations");
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
    const auto curves = simulated_curves(box_of(model), curve_options(family.id, settings.brief), wanted,
                                         work_folder(settings, "uniaxial") / (family.id + ".txt"));
    for (const auto& curve : curves) {
      const auto prepared = evaluator.design(curve.parameters);
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
        errors.push_back(100 * std::abs(state.directional_stress / load.stress - 1));
        curve_errors.push_back(100 * std::abs(state.directional_stress - load.stress) / largest);
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
  report.write(
      settings.command("uniaxial"), settings.brief,
      "Random designs and directions that no data set holds, strains at 24 places from 30 % compression to 50 % "
      "tension, "
      "simulated with the mesh of the family's data set. The simulation pulls along a direction of space; its stress "
      "is "
      "uniaxial along a direction m of the material, along which the network is asked for the same m^T E m, each state "
      "from rest. Errors are |s - s*| / |s*| of the directional stress s = m^T S m at each place, as the thesis's "
      "relative error; beside it the same difference over the largest |s*| of its curve. CPU time, one thread; "
      "simulations that an earlier run has kept in the work folder have the time they took then.");
}

}  // namespace supple::bench
