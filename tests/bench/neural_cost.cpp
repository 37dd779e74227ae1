// What a network's accuracy costs: its error on unseen designs against its width and the number of designs that it is
// trained on, with the time to train and to evaluate; and what more designs would cost where the error is too large.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/dataset/dataset_file.h"
#include "supple/neural/evaluator.h"
#include "supple/training/model_card.h"
#include "supple/training/model_errors.h"
#include "supple/training/model_training.h"

namespace supple::bench {
namespace {

constexpr const char* cost_family = "IH67";

dataset::Dataset data_of(const NeuralSettings& settings, const std::string& of_family) {
  auto data = dataset::read_dataset(settings.models / "datasets" / (of_family + ".h5"));
  if (settings.brief) data.designs.resize(40);
  return data;
}

/// The rows of the first designs of the sequence, so many that they are `share` of all.
std::vector<int> of_first_designs(const training::Samples& samples, const std::vector<int>& rows, double share,
                                  int& designs) {
  std::vector<const training::SampledDesign*> of_row;
  std::vector<const training::SampledDesign*> all;
  for (const int row : rows) {
    const auto after = std::upper_bound(samples.designs.begin(), samples.designs.end(), row,
                                        [](int r, const auto& design) { return r < design.first; });
    of_row.push_back(&*(after - 1));
    if (all.empty() || all.back() != of_row.back()) all.push_back(of_row.back());
  }
  // Designs come by index, and the sequence of indices covers the box evenly however early it ends.
  designs = static_cast<int>(share * static_cast<double>(all.size()) + 0.5);
  const auto* last = all[static_cast<std::size_t>(designs - 1)];
  std::vector<int> kept;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (of_row[i]->index <= last->index) kept.push_back(rows[i]);
  return kept;
}

/// Trained the first time and kept in the work folder, with the CPU seconds of all threads as its time: what others do
/// on the machine counts less in them. Minutes each, so that a run that was stopped loses one at most.
neural::Model trained_model(const std::filesystem::path& file, const std::string& of_family,
                            const training::Samples& samples, const training::Split& split,
                            const training::TrainingOptions& options) {
  if (std::filesystem::exists(file)) return neural::read_model(file);
  training::TrainingResult result;
  const double seconds =
      cpu_time([&] { result = training::train(samples, split, options, {}, {}, [](const auto&) {}); });
  neural::Model model;
  model.id = "cost";
  model.family = of_family;
  model.network = result.network;
  model.provenance.rows = static_cast<std::int64_t>(split.training.size());
  model.provenance.training_seconds = seconds;
  model.provenance.options = training::describe(options);
  model.design_split = training::split_errors(result.network, samples, split.test);
  neural::write_model(file, model);
  return model;
}

/// Microseconds a strain of energy, stress and tangent, fifty strains of one design.
double evaluation_time(const neural::Network& network, int repetitions) {
  const neural::Evaluator evaluator(network);
  const Eigen::VectorXd middle = 0.5 * (network.lower + network.upper);
  const auto design = evaluator.design(std::vector<double>(middle.begin(), middle.end()));
  const Eigen::Matrix3Xd strains = 0.2 * Eigen::Matrix3Xd::Random(3, 50);
  neural::Evaluator::Workspace workspace;
  neural::Evaluation answer;
  std::vector<double> times;
  for (int i = 0; i < repetitions; ++i)
    times.push_back(cpu_time([&] { evaluator.evaluate(design, strains, neural::Order::tangent, workspace, answer); }));
  return 1e6 * least(times) / 50;
}

/// Slope of the line that fits the points best.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  const double x0 = mean(x);
  const double y0 = mean(y);
  double above = 0;
  double below = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    above += (x[i] - x0) * (y[i] - y0);
    below += (x[i] - x0) * (x[i] - x0);
  }
  return above / below;
}

/// Two significant digits, with separators between thousands.
std::string rough(double value) {
  const double digit = std::pow(10, std::floor(std::log10(value)) - 1);
  return value < 100 ? number(value, 2) : count(std::round(value / digit) * digit);
}

}  // namespace

void study_cost(const NeuralSettings& settings) {
  const auto folder = work_folder(settings, "cost");
  Report report(settings.folder, "models-cost", "Models: what accuracy costs");
  Table table("models-cost", {{"width", "Width"},
                              {"designs", "Designs trained on"},
                              {"rows", "States"},
                              {"gradient_percent", "Stress, mean error %"},
                              {"gradient_median", "Median %"},
                              {"gradient_99", "99th percentile %"},
                              {"energy_percent", "Energy, mean error %"},
                              {"training_seconds", "Core-seconds to train"},
                              {"microseconds", "us a strain with tangent"}});
  const auto samples = training::read_samples({data_of(settings, cost_family), {}});
  const auto whole = training::split(samples);
  const int epochs = settings.brief ? 1 : 60;
  const std::vector<int> widths = settings.brief ? std::vector{16, 32} : std::vector{32, 64, 96, 128};
  int tested = 0;
  for (const int width : widths) {
    for (const double share : {0.25, 0.5, 1.0}) {
      int designs = 0;
      auto split = whole;
      split.training = of_first_designs(samples, whole.training, share, designs);
      training::TrainingOptions options;
      options.shape.width = width;
      options.shape.parameters = static_cast<int>(samples.lower.size());
      options.epochs = epochs;
      options.symmetries = training::energy_symmetries(tiling::family(cost_family));
      const std::string name = "width-" + std::to_string(width) + "-designs-" + std::to_string(designs) + "-epochs-" +
                               std::to_string(epochs) + ".h5";
      const auto model = trained_model(folder / name, cost_family, samples, split, options);
      const auto& errors = *model.design_split;
      tested = static_cast<int>(errors.designs);
      table.row({std::to_string(width), std::to_string(designs), std::to_string(split.training.size()),
                 number(100 * errors.gradient.mean), number(100 * errors.gradient.median),
                 number(100 * errors.gradient.percentile_99), number(100 * errors.energy.mean),
                 number(model.provenance.training_seconds),
                 number(evaluation_time(model.network, settings.brief ? 2 : 200))});
    }
  }
  report.table(table);
  report.image("models-cost.svg", "Error against seconds to train and microseconds to evaluate");
  report.write(neural_introduction(
      settings, "cost",
      "Networks of IH67, trained for " + std::to_string(epochs) +
          " epochs with the defaults of `supple-lab train` on a quarter, a half and all of the training designs of "
          "models/datasets. Errors are relative ones on " +
          std::to_string(tested) +
          " designs that none of them has seen. Training is the CPU time of all threads; evaluations are energy, "
          "stress and tangent of 50 strains of one design, CPU time of one thread. The shipped model's card says how "
          "long that one was trained."));
}

void study_data(const NeuralSettings& settings) {
  const auto folder = work_folder(settings, "data");
  Report report(settings.folder, "models-data", "Models: what more designs would cost");
  Table table("models-data", {{"family", "Family"},
                              {"designs", "Designs trained on"},
                              {"rows", "States"},
                              {"epochs", "Epochs"},
                              {"gradient_percent", "Stress, mean error %"},
                              {"gradient_median", "Median %"},
                              {"energy_percent", "Energy, mean error %"},
                              {"training_seconds", "Core-seconds to train"}});
  Table need("models-data-need", {{"family", "Family"},
                                  {"designs", "Designs trained on"},
                                  {"hours", "Core-hours to simulate all"},
                                  {"gradient_percent", "Stress, mean error of the shipped network %"},
                                  {"published_percent", "Thesis %"},
                                  {"exponent", "Error falls as designs^-a, a"},
                                  {"more_designs", "Designs for the thesis's error"},
                                  {"more_hours", "Core-hours to simulate them"}});
  auto models = models_of(settings);
  if (settings.brief) models.resize(1);
  for (const auto& shipped : models) {
    const auto published = training::published_errors(shipped.family);
    const bool wanted = !settings.families.empty() || settings.brief;
    if (!published || (!wanted && shipped.design_split->gradient.mean <= published->gradient)) continue;
    const auto data = data_of(settings, shipped.family);
    double simulated = 0;
    for (const auto& design : data.designs) simulated += design.seconds;
    const auto samples = training::read_samples({data, {}});
    const auto whole = training::split(samples);
    std::vector<double> log_designs;
    std::vector<double> log_error;
    int most = 0;
    for (const double share : {0.25, 0.5, 1.0}) {
      int designs = 0;
      auto split = whole;
      split.training = of_first_designs(samples, whole.training, share, designs);
      training::TrainingOptions options;
      options.shape.width = settings.brief ? 16 : 96;
      options.shape.parameters = static_cast<int>(samples.lower.size());
      // As many steps for each, so that all are trained alike.
      const double rows = 3e6;
      options.epochs =
          settings.brief ? 1 : static_cast<int>(std::ceil(rows / static_cast<double>(split.training.size())));
      options.symmetries = training::energy_symmetries(tiling::family(shipped.family));
      const auto file = folder / (shipped.family + "-designs-" + std::to_string(designs) + "-epochs-" +
                                  std::to_string(options.epochs) + ".h5");
      const auto model = trained_model(file, shipped.family, samples, split, options);
      const auto& errors = *model.design_split;
      log_designs.push_back(std::log(designs));
      log_error.push_back(std::log(errors.gradient.mean));
      most = designs;
      table.row({shipped.family, std::to_string(designs), std::to_string(split.training.size()),
                 std::to_string(options.epochs), number(100 * errors.gradient.mean),
                 number(100 * errors.gradient.median), number(100 * errors.energy.mean),
                 number(model.provenance.training_seconds)});
    }
    const double exponent = -slope(log_designs, log_error);
    const double hours = simulated / 3600;
    const double factor = std::pow(shipped.design_split->gradient.mean / published->gradient, 1 / exponent);
    const bool falls = exponent > 0;
    need.row({shipped.family, std::to_string(most), number(hours), number(100 * shipped.design_split->gradient.mean),
              number(100 * published->gradient), number(exponent), falls ? rough(factor * most) : "none",
              falls ? rough(factor * hours) : "none"});
  }
  report.table(table);
  report.heading("How many designs the thesis's error would take");
  report.table(need);
  report.image("models-data.svg", "Error against the number of designs");
  report.write(neural_introduction(
      settings, "data",
      "Families whose network errs more than the thesis's. Networks 96 wide, trained on a quarter, a half and all of "
      "the "
      "training designs of models/datasets, each for as many steps, fewer than the shipped ones; errors are relative "
      "ones on designs that none of them has seen. The power law that fits these three errors best says how many "
      "designs would bring the shipped network's error to the thesis's, which is of another kind of split, by rows: an "
      "extrapolation by more than it was fitted on, at the present cost of a design, with the present network."));
}

}  // namespace supple::bench
