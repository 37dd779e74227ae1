#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/training/trainer.h"

namespace supple::training {
namespace {

/// A number that differs between networks: a weighted sum of their weights and biases.
double fingerprint(const neural::Network& network) {
  double sum = 0;
  double factor = 1;
  for (const auto* layers : {&network.strain, &network.parameter, &network.trunk, &network.stiffness})
    for (const auto& layer : *layers) sum += ++factor * (layer.weights.sum() + layer.bias.sum());
  return sum;
}

}  // namespace

std::string_view to_string(OptimizerKind kind) { return kind == OptimizerKind::soap ? "soap" : "adam"; }

OptimizerKind optimizer_of(std::string_view name) {
  for (const auto kind : {OptimizerKind::soap, OptimizerKind::adam})
    if (to_string(kind) == name) return kind;
  throw Error("training.invalid_option", fmt::format("There is no optimizer {}; the optimizers are soap, adam.", name));
}

std::string_view to_string(DeviceKind kind) {
  return kind == DeviceKind::automatic ? "automatic" : kind == DeviceKind::cpu ? "cpu" : "cuda";
}

DeviceKind device_of(std::string_view name) {
  for (const auto kind : {DeviceKind::automatic, DeviceKind::cpu, DeviceKind::cuda})
    if (to_string(kind) == name) return kind;
  throw Error("training.invalid_option",
              fmt::format("There is no device {}; the devices are automatic, cpu, cuda.", name),
              {{"device", "automatic, cpu or cuda"}});
}

std::string_view to_string(LossKind kind) { return kind == LossKind::robust ? "robust" : "squared"; }

LossKind loss_of(std::string_view name) {
  for (const auto kind : {LossKind::robust, LossKind::squared})
    if (to_string(kind) == name) return kind;
  throw Error("training.invalid_option", fmt::format("There is no loss {}; the losses are robust, squared.", name),
              {{"loss", "robust or squared"}});
}

std::vector<std::pair<std::string, std::string>> describe(const TrainingOptions& options) {
  std::vector<std::pair<std::string, std::string>> all;
  const auto add = [&](const char* name, const auto& value) { all.emplace_back(name, fmt::format("{}", value)); };
  const auto& shape = options.shape;
  add("form", to_string(shape.form));
  add("activation", to_string(shape.activation));
  add("width", shape.width);
  add("strain_layers", shape.strain_layers);
  add("parameter_layers", shape.parameter_layers);
  add("trunk_layers", shape.trunk_layers);
  add("residuals", shape.residuals);
  add("stiffness_width", shape.stiffness_width);
  add("stiffness_layers", shape.stiffness_layers);
  add("rest", to_string(shape.rest));
  add("features", shape.features);
  add("epochs", options.epochs);
  add("chunk_rows", options.chunk_rows);
  add("batch_chunks", options.batch_chunks);
  add("learning_rate", options.learning_rate);
  add("last_learning_rate", options.final_learning_rate);
  add("largest_gradient", options.max_gradient_norm);
  add("weight_decay", options.weight_decay);
  add("loss", to_string(options.loss));
  add("energy_weight", options.energy_weight);
  add("stress_weight", options.stress_weight);
  add("tangent_weight", options.tangent_weight);
  add("tangent_begin", options.tangent_begin);
  add("error_floor", options.error_floor);
  add("optimizer", to_string(options.optimizer));
  add("smallest_input_scale", options.min_input_scale);
  add("largest_input_scale", options.max_input_scale);
  if (options.start) add("start", fingerprint(*options.start));
  add("stiffness_steps", options.stiffness_steps);
  add("stiffness_batch", options.stiffness_batch);
  add("freeze_stiffness", options.freeze_stiffness ? 1 : 0);
  add("patience", options.patience);
  add("validation_interval", options.validation_interval);
  add("symmetries", options.symmetries.size());
  add("seed", options.seed);
  return all;
}

void check(const TrainingOptions& options, const Samples& samples) {
  const auto require = [](bool is_met, const char* name, const std::string& range) {
    if (!is_met) throw Error("training.invalid_option", fmt::format("{} must be {}.", name, range), {{name, range}});
  };
  require(options.shape.parameters == static_cast<int>(samples.lower.size()), "parameters", "the data set's number");
  require(options.shape.width >= 16 && options.shape.width % 16 == 0, "width", "a multiple of 16");
  if (const auto& start = options.start)
    require(start->shape == options.shape && std::ranges::equal(start->lower, samples.lower) &&
                std::ranges::equal(start->upper, samples.upper),
            "start", "a network of the shape and the bounds that are trained");
  require(options.shape.features == static_cast<int>(options.geometry.features.size()), "features",
          "as many as the geometry lists");
  require(options.shape.rest == neural::RestForm::free || options.shape.form == neural::EnergyForm::sum_of_squares,
          "rest", "free where the energy is no sum of squares");
  require(options.shape.stiffness_width >= 1, "stiffness_width", "at least 1");
  require(options.shape.stiffness_layers >= 1, "stiffness_layers", "at least 1");
  require(options.stiffness_steps >= 0, "stiffness_steps", "not negative");
  require(options.stiffness_batch >= 1, "stiffness_batch", "at least 1");
  require(options.epochs >= 1, "epochs", "at least 1");
  require(options.chunk_rows >= 1, "chunk_rows", "at least 1");
  require(options.batch_chunks >= 1, "batch_chunks", "at least 1");
  require(options.learning_rate > 0, "learning_rate", "positive");
  require(options.final_learning_rate >= 0 && options.final_learning_rate <= options.learning_rate,
          "last_learning_rate", "from 0 to learning_rate");
  require(options.max_gradient_norm > 0, "largest_gradient", "positive");
  require(options.weight_decay >= 0, "weight_decay", "not negative");
  require(options.energy_weight >= 0 && options.stress_weight >= 0 && options.energy_weight + options.stress_weight > 0,
          "energy_weight", "not negative, nor zero together with stress_weight");
  require(options.tangent_weight >= 0, "tangent_weight", "not negative");
  require(options.error_floor > 0, "error_floor", "positive");
  require(options.min_input_scale > 0 && options.max_input_scale >= options.min_input_scale, "largest_input_scale",
          "at least smallest_input_scale, both positive");
  require(options.validation_interval >= 1, "validation_interval", "at least 1");
  require(options.patience >= 0, "patience", "not negative");
}

}  // namespace supple::training
