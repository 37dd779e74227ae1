#include "model_commands.h"

#include <fmt/format.h>
#include <malloc.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/threads.h"
#include "supple/dataset/merge.h"
#include "supple/lab/dataset_options.h"
#include "supple/training/model_card.h"
#include "supple/training/model_training.h"

namespace supple::lab {
namespace {

/// Where a model's data are.
struct DataArguments {
  std::vector<std::filesystem::path> files;
  std::vector<std::filesystem::path> more;
};

void add_data_options(CLI::App& command, DataArguments& arguments) {
  command.add_option("--data", arguments.files, "Data sets of one recipe, or parts of one")->required();
  command.add_option("--more", arguments.more,
                     "Data for training only, e.g. of a part of the box: each a recipe of its own, simulated alike");
}

training::ModelData read_data(const DataArguments& arguments) {
  training::ModelData data{dataset::read_parts(arguments.files), {}};
  for (const auto& file : arguments.more) data.more.push_back(dataset::read_finished_or_partial(file));
  return data;
}

std::string names_of(const DataArguments& arguments) {
  std::string names;
  for (const auto* files : {&arguments.files, &arguments.more})
    for (const auto& file : *files) names += (names.empty() ? "" : " ") + file.filename().string();
  return names;
}

struct TrainArguments {
  training::ModelOptions options;
  std::string family;
  DataArguments data;
  std::filesystem::path start;
  std::filesystem::path out;
  std::filesystem::path log;
  std::string form = "sum_of_squares";
  std::string activation = "swish";
  std::string optimizer = "soap";
  int threads = 0;
  bool quiet = false;
};

std::filesystem::path checkpoint_path(const std::filesystem::path& out) {
  auto path = out;
  return path += ".partial";
}

void write_log(const std::filesystem::path& path, const std::vector<training::EpochReport>& history) {
  std::ofstream log(path);
  log << "epoch,loss,validation_gradient,validation_energy,validation_stiffness,learning_rate,seconds\n";
  for (const auto& r : history) {
    const auto measured = [](double error) { return error < 0 ? std::string() : fmt::format("{:.6g}", error); };
    log << fmt::format("{},{:.6g},{},{},{},{:.6g},{:.1f}\n", r.epoch, r.loss, measured(r.validation_gradient),
                       measured(r.validation_energy), measured(r.validation_stiffness), r.learning_rate, r.seconds);
  }
  if (!log) throw Error("file.write_failed", "Cannot write " + path.string() + ".");
}

void print_errors(const char* split, const neural::SplitErrors& errors) {
  const auto line = [&](const char* what, const neural::ErrorStatistics& e) {
    fmt::print("{:12} {:9} mean {:6.3f} %, RMS {:6.3f} %, median {:6.3f} %, 99th percentile {:6.2f} %\n", split, what,
               100 * e.mean, 100 * e.root_mean_square, 100 * e.median, 100 * e.percentile_99);
  };
  line("gradient", errors.gradient);
  line("energy", errors.energy);
}

/// Each step of a training allocates and frees the same tensors: without these the allocator gives pages back to the
/// system and takes them anew, a fifth of the time.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

void train(TrainArguments& arguments, const StopSignals& signals, bool& interrupted) {
  keep_freed_memory();
  auto& training = arguments.options.training;
  training.shape.form = neural::energy_form_of(arguments.form);
  training.shape.activation = neural::activation_of(arguments.activation);
  training.optimizer = training::optimizer_of(arguments.optimizer);
  set_thread_count(arguments.threads);
  const auto data = read_data(arguments.data);
  const auto& family = data.data.recipe.text("family");
  if (!arguments.family.empty() && family != arguments.family)
    throw Error("training.invalid_option",
                fmt::format("The data set is of the family {}, not {}.", family, arguments.family),
                {{"family", family}});
  if (!arguments.start.empty()) arguments.options.start = neural::read_model(arguments.start);
  const auto checkpoint = checkpoint_path(arguments.out);
  const auto report = [&](const training::EpochReport& r) {
    if (arguments.quiet || r.validation_gradient < 0) return;
    fmt::print(
        stderr,
        "epoch {}/{}: loss {:.4f}, validation: gradient {:.2f} %, energy {:.2f} %, stiffness {:.2f} %; {:.0f} s\n",
        r.epoch, training.epochs, r.loss, 100 * r.validation_gradient, 100 * r.validation_energy,
        100 * r.validation_stiffness, r.seconds);
  };
  const auto result = training::train_model(data, names_of(arguments.data), engine_version(), arguments.options,
                                            checkpoint, signals.cancellation(), report);
  if (!arguments.log.empty()) write_log(arguments.log, result.history);
  interrupted = !result.finished;
  if (interrupted) {
    fmt::print(stderr, "interrupted: {} holds {} epochs; the same command goes on\n", checkpoint.string(),
               result.history.size());
    return;
  }
  neural::write_model(arguments.out, result.model);
  std::filesystem::remove(checkpoint);
  fmt::print("{} holds the model {} (epoch {} of {}), {} weights\n", arguments.out.string(), result.model.id,
             result.best_epoch, result.history.size(), result.model.network.weights());
  print_errors("design split", *result.model.design_split);
  print_errors("row split", *result.model.row_split);
}

void add_options(CLI::App& command, TrainArguments& arguments) {
  auto& options = arguments.options;
  auto& training = options.training;
  auto& shape = training.shape;
  add_data_options(command, arguments.data);
  command.add_option("--out", arguments.out, "The model; until it is finished, OUT.partial keeps what is done")
      ->required();
  command.add_option("--start", arguments.start,
                     "A model of the same data and split: training goes on with it, and its network's shape holds");
  command.add_option("--family", arguments.family, "Refuses data of another");
  command.add_option("--id", options.id, "Of the model; the family's unless given");
  command.add_option("--log", arguments.log, "CSV file of losses and validation errors");
  command.add_option("--threads", arguments.threads, "0: one for each core")->capture_default_str();
  command.add_flag("--quiet", arguments.quiet, "No progress on stderr");
  const auto group_of = [&](const char* group) {
    return [&command, group](const char* name, auto& value, const char* about) {
      command.add_option(name, value, about)->capture_default_str()->group(group);
    };
  };
  const auto network = group_of("Network");
  network("--width", shape.width, "Neurons of each layer, a multiple of 16");
  network("--strain-layers", shape.strain_layers, "Of the branch that reads the strain");
  network("--parameter-layers", shape.parameter_layers, "Of the branch that reads the parameters");
  network("--trunk-layers", shape.trunk_layers, "After both branches meet");
  network("--residuals", shape.residuals, "Terms of the sum of squares");
  network("--stiffness-width", shape.stiffness_width, "Neurons of the stiffness branch");
  network("--activation", arguments.activation, "swish, tanh or sine");
  network("--form", arguments.form, "sum_of_squares or softplus");
  const auto rule = group_of("Training");
  rule("--epochs", training.epochs, "Passes over the training rows");
  rule("--chunk-rows", training.chunk_rows, "Rows of one design that go together");
  rule("--batch-chunks", training.batch_chunks, "Chunks of one step");
  rule("--learning-rate", training.learning_rate, "At its highest");
  rule("--last-learning-rate", training.last_learning_rate, "At the end");
  rule("--largest-gradient", training.largest_gradient, "Longer ones are shortened");
  rule("--weight-decay", training.weight_decay, "Times the learning rate: the share by which weights shrink in a step");
  rule("--energy-weight", training.energy_weight, "Of the energy's error");
  rule("--stress-weight", training.stress_weight, "Of the stress's error");
  rule("--tangent-weight", training.tangent_weight, "Of the tangent's error");
  rule("--tangent-begin", training.tangent_begin, "Share of the epochs after which the tangent counts");
  rule("--error-floor", training.error_floor, "Relative error below which errors count less");
  rule("--optimizer", arguments.optimizer, "soap or adam");
  rule("--smallest-input-scale", training.smallest_input_scale, "Of strains at the first layer");
  rule("--largest-input-scale", training.largest_input_scale, "Of strains at the first layer");
  rule("--patience", training.patience, "Epochs without a better validation that end training; 0: never");
  rule("--validation-interval", training.validation_interval, "Epochs between validations");
  rule("--seed", training.seed, "Of the weights and the order of rows");
  rule("--symmetry", options.use_symmetry, "See each chunk through the family's symmetries (1 or 0)");
  const auto split = group_of("Samples");
  split("--least-energy", options.samples.least_energy, "MPa; rows below are left out");
  split("--largest-energy", options.samples.largest_energy, "MPa; rows above are left out");
  split("--validation-share", options.split.validation, "Of the designs");
  split("--test-share", options.split.test, "Of the designs");
  split("--row-test-share", options.split.row_test, "Of the rows of the other designs");
  split("--split-seed", options.split.seed, "Which designs and rows these are");
}

struct CardArguments {
  std::filesystem::path model;
  DataArguments data;
  std::filesystem::path out;
  std::filesystem::path rows;
  std::string image;
};

void write_card(const CardArguments& arguments) {
  const auto model = neural::read_model(arguments.model);
  const auto data = read_data(arguments.data);
  std::ofstream page(arguments.out);
  page << training::model_card(model, data, arguments.image);
  if (!page) throw Error("file.write_failed", "Cannot write " + arguments.out.string() + ".");
  if (!arguments.rows.empty()) training::write_row_errors(arguments.rows, model, data);
}

struct SymmetrizeArguments {
  std::filesystem::path model;
  DataArguments data;
  std::filesystem::path out;
};

void symmetrize(const SymmetrizeArguments& arguments) {
  const auto model = training::symmetrized(neural::read_model(arguments.model), read_data(arguments.data));
  neural::write_model(arguments.out, model);
  fmt::print("{} holds the model {}, the mean over {} orientations of a strain\n", arguments.out.string(), model.id,
             model.network.symmetries.size() + 1);
  print_errors("design split", *model.design_split);
  print_errors("row split", *model.row_split);
}

}  // namespace

void add_symmetrize_command(CLI::App& program) {
  const auto arguments = std::make_shared<SymmetrizeArguments>();
  CLI::App* command = program.add_subcommand(
      "symmetrize",
      "Give a model the rotations of its family exactly, at two or three times the time of an evaluation");
  command->add_option("--model", arguments->model, "The model")->required();
  add_data_options(*command, arguments->data);
  command->add_option("--out", arguments->out, "The model with its errors measured anew")->required();
  command->callback([=] { symmetrize(*arguments); });
}

void add_card_command(CLI::App& program) {
  const auto arguments = std::make_shared<CardArguments>();
  CLI::App* command = program.add_subcommand("card", "Write the page about a model: its errors and where they are");
  command->add_option("--model", arguments->model, "The model")->required();
  add_data_options(*command, arguments->data);
  command->add_option("--out", arguments->out, "The page, in Markdown")->required();
  command->add_option("--rows", arguments->rows, "CSV file of the errors of each held-out state");
  command->add_option("--image", arguments->image, "Plot that the page shows")->capture_default_str();
  command->callback([=] { write_card(*arguments); });
}

void add_train_command(CLI::App& program, const StopSignals& signals, bool& interrupted) {
  const auto arguments = std::make_shared<TrainArguments>();
  CLI::App* command =
      program.add_subcommand("train", "Train a network on a data set; interrupted, the same command goes on");
  add_options(*command, *arguments);
  command->callback([=, &signals, &interrupted] { train(*arguments, signals, interrupted); });
}

}  // namespace supple::lab
