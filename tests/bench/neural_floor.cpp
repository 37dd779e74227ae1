// What simulations of one structure and load differ by among themselves: no network can err by less on average.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/neural/uniaxial.h"
#include "uniaxial_curves.h"

namespace supple::bench {
namespace {

/// A way to simulate the same structures under the same loads that nobody would call worse.
struct Variant {
  std::string name;
  std::string file;  ///< of its kept curves
  microscale::SimulationOptions options;
};

std::vector<Variant> variants_of(const std::string& family, bool brief) {
  const auto usual = curve_options(family, brief);
  auto mesh = usual;
  mesh.mesh.mesh_size *= 0.9;
  auto steps = usual;
  steps.max_load_step = 0.02;
  return {{"a mesh of nine tenths the size", "mesh", mesh},
          {"load steps of at most 0.02 instead of 0.05", "steps", steps}};
}

/// Relative differences of the directional stress, in percent.
void add_row(Table& table, const std::string& family, const std::string& what, std::size_t designs,
             const std::vector<double>& differences) {
  if (differences.empty()) return;
  const auto beyond = static_cast<double>(
      std::count_if(differences.begin(), differences.end(), [](double value) { return value > worst_allowed; }));
  table.row({family, what, std::to_string(designs), std::to_string(differences.size()), number(mean(differences)),
             number(median(differences)), number(quantile(differences, 0.9)), number(quantile(differences, 1)),
             number(100 * beyond / static_cast<double>(differences.size()))});
}

std::vector<double> differences(const std::vector<Curve>& curves, const std::vector<Curve>& others) {
  std::vector<double> result;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    for (const Place& place : curves[i].places) {
      const auto& places = others[i].places;
      const auto same =
          std::find_if(places.begin(), places.end(), [&](const Place& p) { return p.stretch == place.stretch; });
      if (same != places.end()) result.push_back(100 * std::abs(same->load.stress / place.load.stress - 1));
    }
  }
  return result;
}

std::vector<double> network_errors(const neural::Model& model, const std::vector<Curve>& curves) {
  const neural::Evaluator evaluator(model.network);
  std::vector<double> errors;
  for (const Curve& curve : curves) {
    const auto prepared = evaluator.design(curve.parameters);
    for (const Place& place : curve.places) {
      const auto predicted =
          neural::uniaxial_path(evaluator, prepared, place.load.direction, std::vector{place.load.green_strain});
      errors.push_back(100 * std::abs(predicted[0].directional_stress / place.load.stress - 1));
    }
  }
  return errors;
}

}  // namespace

void study_floor(const NeuralSettings& settings) {
  Report report(settings.folder, "models-floor", "Models: what simulations differ by among themselves");
  Table table("models-floor", {{"family", "Family"},
                               {"compared", "Compared with the usual simulation"},
                               {"designs", "Designs"},
                               {"places", "Places"},
                               {"mean_percent", "Mean %"},
                               {"median_percent", "Median %"},
                               {"percentile_90", "90th percentile %"},
                               {"worst_percent", "Worst %"},
                               {"beyond_percent", "Places beyond 3.57 %, %"}});
  const int wanted = settings.brief ? 1 : settings.designs_or(25);
  for (const auto& model : models_of(settings)) {
    const DesignBox box = box_of(model);
    const auto curves = simulated_curves(box, curve_options(model.family, settings.brief), wanted,
                                         work_folder(settings, "uniaxial") / (model.family + ".txt"));
    for (const auto& variant : variants_of(model.family, settings.brief)) {
      const auto others = simulated_curves(
          box, variant.options, wanted, work_folder(settings, "floor") / (model.family + "-" + variant.file + ".txt"));
      add_row(table, model.family, variant.name, curves.size(), differences(curves, others));
    }
    add_row(table, model.family, "the network", curves.size(), network_errors(model, curves));
  }
  report.table(table);
  report.write(neural_introduction(
      settings, "floor",
      "Random designs of each model's box under uniaxial loads along random directions, at 24 places from 30 % "
      "compression to 50 % tension, simulated as the family's data set was and once more in ways that are as good: on "
      "another mesh, and with shorter load steps, each of which may lead a structure that buckles to another branch. A "
      "network that learned from such data errs by as much at least. Differences are relative ones of the directional "
      "stress; the share beyond 3.57 % (the thesis's worst error) counts the places at which two simulations "
      "disagree."));
}

}  // namespace supple::bench
