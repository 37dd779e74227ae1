// What a network's accuracy costs: its error on unseen designs against its width and the number of designs that it is
// trained on, with the time to train and to evaluate.
#include <algorithm>
#include <string>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/dataset/dataset_file.h"
#include "supple/neural/evaluator.h"
#include "supple/training/model_errors.h"
#include "supple/training/model_training.h"

namespace supple::bench {
namespace {

constexpr const char* family = "IH67";

dataset::Dataset data_of(const NeuralSettings& settings) {
  auto data = dataset::read_dataset(settings.models / "datasets" / (std::string(family) + ".h5"));
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
neural::Model trained_model(const std::filesystem::path& file, const training::Samples& samples,
                            const training::Split& split, const training::TrainingOptions& options) {
  if (std::filesystem::exists(file)) return neural::read_model(file);
  training::TrainingResult result;
  const double seconds =
      cpu_time([&] { result = training::train(samples, split, options, {}, {}, [](const auto&) {}); });
  neural::Model model;
  model.id = "cost";
  model.family = family;
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
  const auto samples = training::read_samples({data_of(settings), {}});
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
      options.symmetries = training::energy_symmetries(tiling::family(family));
      const std::string name = "width-" + std::to_string(width) + "-designs-" + std::to_string(designs) + "-epochs-" +
                               std::to_string(epochs) + ".h5";
      const auto model = trained_model(folder / name, samples, split, options);
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

}  // namespace supple::bench
