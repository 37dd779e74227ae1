// What the loss, the optimizer and the tangent term of a training give: errors on designs that it has not seen after
// the same number of epochs, and the time of these.
#include <string>
#include <utility>
#include <vector>

#include "measurement.h"
#include "neural_bench.h"
#include "report.h"
#include "supple/base/threads.h"
#include "supple/dataset/dataset_file.h"
#include "supple/tiling/family.h"
#include "supple/training/model_errors.h"
#include "supple/training/model_training.h"

namespace supple::bench {
namespace {

using training::LossKind;
using training::OptimizerKind;

constexpr const char* studied_family = "IH50";

/// The learning rate at its highest, by the second table of the page.
double usual_rate(OptimizerKind optimizer) { return optimizer == OptimizerKind::soap ? 0.005 : 0.003; }

struct Choice {
  LossKind loss = LossKind::robust;
  OptimizerKind optimizer = OptimizerKind::soap;
  double tangent_weight = 0.1;
  double learning_rate = 0.005;
};

struct TrainedOnce {
  training::RowErrors errors;  ///< of the test's designs
  double seconds = 0;          ///< CPU time of all epochs
  /// CPU time and mean error of the stress and median of the stiffness on the designs that choose, as it went.
  struct Moment {
    int epoch = 0;
    double seconds = 0;
    double gradient = 0;
    double stiffness = 0;
  };
  std::vector<Moment> curve;
};

TrainedOnce train_once(const training::Samples& samples, const training::Split& parts,
                       training::TrainingOptions options, const Choice& choice, int seed) {
  options.loss = choice.loss;
  options.optimizer = choice.optimizer;
  options.tangent_weight = choice.tangent_weight;
  options.learning_rate = choice.learning_rate;
  options.seed = seed;
  TrainedOnce made;
  const double begin = cpu_seconds();
  const auto result = training::train(samples, parts, options, {}, {}, [&](const training::EpochReport& r) {
    if (r.validation_gradient >= 0)
      made.curve.push_back({r.epoch, cpu_seconds() - begin, r.validation_gradient, r.validation_stiffness});
  });
  made.seconds = cpu_seconds() - begin;
  made.errors = training::row_errors(result.network, samples, parts.test);
  return made;
}

/// Means over seeds, in percent but for the last.
struct Summary {
  double gradient = 0;
  double gradient_median = 0;
  double gradient_99 = 0;
  double energy = 0;
  double stiffness = 0;
  double seconds = 0;
};

Summary summary_of(const std::vector<TrainedOnce>& runs) {
  Summary sum;
  const auto share = 1.0 / static_cast<double>(runs.size());
  for (const auto& run : runs) {
    sum.gradient += 100 * share * run.errors.gradient.mean();
    sum.gradient_median += 100 * share * training::quantile(run.errors.gradient, 0.5);
    sum.gradient_99 += 100 * share * training::quantile(run.errors.gradient, 0.99);
    sum.energy += 100 * share * run.errors.energy.mean();
    sum.stiffness += 100 * share * training::quantile(run.errors.stiffness, 0.5);
    sum.seconds += share * run.seconds;
  }
  return sum;
}

std::vector<std::string> cells_of(const Summary& s) {
  return {number(s.gradient), number(s.gradient_median), number(s.gradient_99),
          number(s.energy),   number(s.stiffness),       number(s.seconds)};
}

std::vector<Table::Column> with_errors(std::vector<Table::Column> columns) {
  for (auto& column : std::vector<Table::Column>{{"gradient_percent", "Stress, mean error %"},
                                                 {"gradient_median", "Median %"},
                                                 {"gradient_99", "99th percentile %"},
                                                 {"energy_percent", "Energy, mean error %"},
                                                 {"stiffness_median", "Stiffness, median %"},
                                                 {"seconds", "Core-seconds"}})
    columns.push_back(std::move(column));
  return columns;
}

}  // namespace

void study_training(const NeuralSettings& settings) {
  Report report(settings.folder, "training-loss", "Training: loss, optimizer and tangent term");
  Table table("training-loss",
              with_errors({{"loss", "Loss"}, {"optimizer", "Optimizer"}, {"tangent", "Tangent term"}}));
  Table rates("training-loss-rates", with_errors({{"optimizer", "Optimizer"}, {"rate", "Learning rate"}}));
  Table curves("training-loss-curves", {{"loss", "Loss"},
                                        {"optimizer", "Optimizer"},
                                        {"tangent", "Tangent term"},
                                        {"seed", "Seed"},
                                        {"epoch", "Epoch"},
                                        {"seconds", "Core-seconds"},
                                        {"gradient_percent", "Stress, mean error %"},
                                        {"stiffness_median", "Stiffness, median %"}});
  auto data = dataset::read_dataset(settings.models / "datasets" / (std::string(studied_family) + ".h5"));
  if (settings.brief) data.designs.resize(40);
  const auto samples = training::read_samples({std::move(data), {}, {}});
  const auto parts = training::split(samples);
  training::TrainingOptions options;
  options.shape.width = settings.brief ? 16 : 64;
  options.shape.parameters = static_cast<int>(samples.lower.size());
  options.symmetries = training::energy_symmetries(tiling::family(studied_family));
  options.epochs = settings.brief ? 2 : 40;
  options.validation_interval = 2;
  options.device = training::DeviceKind::cpu;
  const int seeds = settings.brief ? 1 : 2;
  // Core-seconds of several threads would count their waiting for each other.
  set_thread_count(1);
  const auto add_curves = [&](const Choice& choice, const std::vector<TrainedOnce>& runs) {
    for (std::size_t i = 0; i < runs.size(); ++i)
      for (const auto& moment : runs[i].curve)
        curves.row({std::string(to_string(choice.loss)), std::string(to_string(choice.optimizer)),
                    number(choice.tangent_weight, 1), std::to_string(i + 1), std::to_string(moment.epoch),
                    number(moment.seconds), number(100 * moment.gradient), number(100 * moment.stiffness)});
  };
  for (const auto optimizer : {OptimizerKind::soap, OptimizerKind::adam}) {
    for (const auto loss : {LossKind::robust, LossKind::squared}) {
      for (const double tangent : {0.0, 0.1}) {
        const Choice choice{loss, optimizer, tangent, usual_rate(optimizer)};
        std::vector<TrainedOnce> runs;
        for (int seed = 1; seed <= seeds; ++seed) runs.push_back(train_once(samples, parts, options, choice, seed));
        const auto summary = summary_of(runs);
        auto cells = cells_of(summary);
        cells.insert(cells.begin(),
                     {std::string(to_string(loss)), std::string(to_string(optimizer)), number(tangent, 1)});
        table.row(std::move(cells));
        add_curves(choice, runs);
      }
    }
  }
  for (const auto optimizer : {OptimizerKind::soap, OptimizerKind::adam}) {
    for (const double factor : {0.3, 1.0, 3.0}) {
      const double rate = factor * usual_rate(optimizer);
      auto cells =
          cells_of(summary_of({train_once(samples, parts, options, {LossKind::robust, optimizer, 0.1, rate}, 1)}));
      cells.insert(cells.begin(), {std::string(to_string(optimizer)), number(rate, 2)});
      rates.row(std::move(cells));
    }
  }
  set_thread_count(0);
  report.table(table);
  report.image("training-loss.svg", "Mean error of the stress, and median of the stiffness, against core-seconds");
  report.text(
      "The curves are of designs that choose the best epoch, not of those of the table: "
      "[CSV](training-loss-curves.csv).");
  report.data(curves);
  report.heading("Learning rates");
  report.text("The robust loss with the tangent term, first seed: the rates above are the middle ones.");
  report.table(rates);
  report.write(neural_introduction(
      settings, "training",
      "Networks " + std::to_string(options.shape.width) + " wide learn " +
          count(static_cast<double>(parts.training.size())) + " states of " + studied_family + " in " +
          std::to_string(options.epochs) + " epochs, on one thread; means over " + std::to_string(seeds) +
          " seeds. `squared` is the thesis's loss (4.8), the sum "
          "of squares of the relative errors of energy and "
          "stress; "
          "`robust` is ours, log(1 + sqrt(x^2 + 0.005^2)) of each relative error x. The tangent term adds, with this "
          "weight, the loss of the relative error of the tangent stiffness along random directions after a fifth of "
          "the "
          "epochs. SOAP's learning rate is 0.005 at its highest, Adam's 0.003; gradients longer than 1 are shortened "
          "in "
          "all. Errors are relative ones on " +
          count(static_cast<double>(parts.test.size())) +
          " states of designs that training has not seen; the stiffness is that against more of the state's own load. "
          "Core-seconds are those of one thread's work, reports included. The trainings are short: the networks that "
          "are "
          "shipped took hundreds of epochs."));
}

}  // namespace supple::bench
