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
#include "supple/lab/engine_version.h"
#include "supple/training/mesh_correction.h"
#include "supple/training/model_calibration.h"
#include "supple/training/model_card.h"
#include "supple/training/model_training.h"

namespace supple::lab {
namespace {

/// Files of a model's data (training::ModelData).
struct DataArguments {
  std::vector<std::filesystem::path> files;
  std::vector<std::filesystem::path> more;
  std::vector<std::filesystem::path> rest;
};

void add_data_options(CLI::App& command, DataArguments& arguments) {
  command.add_option("--data", arguments.files, "Data sets of one recipe, or parts of one")->required();
  command.add_option("--more", arguments.more,
                     "Data for training only, e.g. of a part of the box: each a recipe of its own, simulated alike");
}

training::ModelData read_data(const DataArguments& arguments) {
  training::ModelData data{dataset::read_parts(arguments.files), {}, {}};
  for (const auto& file : arguments.more) data.more.push_back(dataset::read_finished_or_partial(file));
  for (const auto& file : arguments.rest) data.rest.push_back(dataset::read_finished_or_partial(file));
  return data;
}

std::string names_of(const DataArguments& arguments) {
  std::string names;
  for (const auto* files : {&arguments.files, &arguments.more, &arguments.rest})
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
  std::filesystem::path exported;
  std::filesystem::path imported;
  std::string form = "sum_of_squares";
  std::string activation = "swish";
  std::string optimizer = "soap";
  std::string loss = "robust";
  std::string device = "automatic";
  std::string rest_form = "free";
  std::string features = "none";
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

void print_stiffness(const training::StiffnessReport& r, int steps) {
  std::string unseen;
  if (r.unseen_mean >= 0)
    unseen = fmt::format(", unseen mean {:.2f} %, median {:.2f} %", 100 * r.unseen_mean, 100 * r.unseen_median);
  fmt::print(stderr,
             "stiffness {}/{}: along the worst direction {} designs mean {:.2f} %, median {:.2f} %{}; {:.0f} s\n",
             r.step, steps, r.designs, 100 * r.trained_mean, 100 * r.trained_median, unseen, r.seconds);
}

/// Makes the allocator keep freed memory. Each step of a training allocates and frees the same tensors. Without this,
/// the allocator returns their pages to the system and requests them anew, which takes a fifth of the time.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

void finish(const training::ModelResult& result, const std::filesystem::path& out) {
  neural::write_model(out, result.model);
  fmt::print("{} holds the model {}, {} weights\n", out.string(), result.model.id, result.model.network.weights());
  print_errors("design split", *result.model.design_split);
  print_errors("row split", *result.model.row_split);
}

void train(TrainArguments& arguments, const StopSignals& signals, bool& interrupted) {
  keep_freed_memory();
  auto& training = arguments.options.training;
  training.shape.form = neural::energy_form_of(arguments.form);
  training.shape.activation = neural::activation_of(arguments.activation);
  training.optimizer = training::optimizer_of(arguments.optimizer);
  training.loss = training::loss_of(arguments.loss);
  training.device = training::device_of(arguments.device);
  training.shape.rest = neural::rest_form_of(arguments.rest_form);
  arguments.options.use_features = arguments.features == "geometric";
  set_thread_count(arguments.threads);
  const auto data = read_data(arguments.data);
  const auto& family = data.data.recipe.text("family");
  if (!arguments.family.empty() && family != arguments.family)
    throw Error("training.invalid_option",
                fmt::format("The data set is of the family {}, not {}.", family, arguments.family),
                {{"family", family}});
  if (!arguments.start.empty()) arguments.options.start = neural::read_model(arguments.start);
  const auto report_stiffness = [&](const training::StiffnessReport& r) {
    if (!arguments.quiet) print_stiffness(r, training.stiffness_steps);
  };
  if (!arguments.exported.empty()) {
    interrupted = !training::export_model_training(data, arguments.options, arguments.exported, signals.cancellation(),
                                                   report_stiffness);
    if (!interrupted) fmt::print("{} holds the training for another trainer\n", arguments.exported.string());
    return;
  }
  if (!arguments.imported.empty()) {
    finish(training::import_model_training(data, names_of(arguments.data), engine_version(), arguments.options,
                                           arguments.imported),
           arguments.out);
    return;
  }
  const auto checkpoint = checkpoint_path(arguments.out);
  if (const auto device = training::usable_device(training.device); !arguments.quiet)
    fmt::print(stderr, "training on {}\n", to_string(device));
  const auto report = [&](const training::EpochReport& r) {
    if (arguments.quiet || r.validation_gradient < 0) return;
    fmt::print(
        stderr,
        "epoch {}/{}: loss {:.4f}, validation: gradient {:.2f} %, energy {:.2f} %, stiffness {:.2f} %; {:.0f} s\n",
        r.epoch, training.epochs, r.loss, 100 * r.validation_gradient, 100 * r.validation_energy,
        100 * r.validation_stiffness, r.seconds);
  };
  const auto result = training::train_model(data, names_of(arguments.data), engine_version(), arguments.options,
                                            checkpoint, signals.cancellation(), report, report_stiffness);
  if (!arguments.log.empty()) write_log(arguments.log, result.history);
  interrupted = !result.finished;
  if (interrupted) {
    fmt::print(stderr, "interrupted: {} holds {} epochs; the same command goes on\n", checkpoint.string(),
               result.history.size());
    return;
  }
  finish(result, arguments.out);
  std::filesystem::remove(checkpoint);
  fmt::print("epoch {} of {} was the best\n", result.best_epoch, result.history.size());
}

/// Adds options with defaults to a group of the help.
auto options_of(CLI::App& command, const char* group) {
  return [&command, group](const char* name, auto& value, const char* about) {
    return command.add_option(name, value, about)->capture_default_str()->group(group);
  };
}

void add_network_options(CLI::App& command, TrainArguments& arguments) {
  auto& shape = arguments.options.training.shape;
  const auto network_option = options_of(command, "Network");
  network_option("--width", shape.width, "Neurons of each layer, a multiple of 16");
  network_option("--strain-layers", shape.strain_layers, "Of the branch that reads the strain");
  network_option("--parameter-layers", shape.parameter_layers, "Of the branch that reads the parameters");
  network_option("--trunk-layers", shape.trunk_layers, "After both branches meet");
  network_option("--residuals", shape.residuals, "Terms of the sum of squares");
  network_option("--stiffness-width", shape.stiffness_width, "Neurons of each hidden layer of the stiffness branch");
  network_option("--stiffness-layers", shape.stiffness_layers, "Hidden layers of the stiffness branch");
  network_option("--activation", arguments.activation, "swish, tanh or sine");
  network_option("--form", arguments.form, "sum_of_squares or softplus");
  network_option("--rest", arguments.rest_form,
                 "exact: the stiffness at rest is the stiffness branch's alone; free: learned by all")
      ->check(CLI::IsMember({"exact", "free"}));
  network_option("--features", arguments.features,
                 "geometric: lengths, gaps, angles and density of the tile are inputs; or none")
      ->check(CLI::IsMember({"geometric", "none"}));
}

void add_training_options(CLI::App& command, TrainArguments& arguments) {
  auto& training = arguments.options.training;
  const auto training_option = options_of(command, "Training");
  training_option("--epochs", training.epochs, "Passes over the training rows");
  training_option("--chunk-rows", training.chunk_rows, "Rows of one design that go together");
  training_option("--batch-chunks", training.batch_chunks, "Chunks of one step");
  training_option("--learning-rate", training.learning_rate, "At its highest");
  training_option("--last-learning-rate", training.final_learning_rate, "At the end");
  training_option("--largest-gradient", training.max_gradient_norm, "Longer ones are shortened");
  training_option("--weight-decay", training.weight_decay,
                  "Times the learning rate: the share by which weights shrink in a step");
  training_option("--loss", arguments.loss,
                  "Of a relative error x: robust, log(1 + sqrt(x^2 + floor^2)), or squared, x^2 (the thesis's 4.8)")
      ->check(CLI::IsMember({"robust", "squared"}));
  training_option("--energy-weight", training.energy_weight, "Of the energy's error");
  training_option("--stress-weight", training.stress_weight, "Of the stress's error");
  training_option("--tangent-weight", training.tangent_weight, "Of the tangent's error");
  training_option("--tangent-begin", training.tangent_begin, "Share of the epochs after which the tangent counts");
  training_option("--error-floor", training.error_floor,
                  "Of the robust loss: relative error below which errors count less");
  training_option("--optimizer", arguments.optimizer, "soap or adam")->check(CLI::IsMember({"soap", "adam"}));
  training_option("--smallest-input-scale", training.min_input_scale, "Of strains at the first layer");
  training_option("--largest-input-scale", training.max_input_scale, "Of strains at the first layer");
  training_option("--stiffness-steps", training.stiffness_steps, "That fit the stiffness branch before all else");
  training_option("--stiffness-batch", training.stiffness_batch, "Designs of one of these steps");
  command.add_flag("--freeze-stiffness", training.freeze_stiffness, "Leave the stiffness branch as it was fitted")
      ->group("Training");
  training_option("--patience", training.patience, "Epochs without a better validation that end training; 0: never");
  training_option("--validation-interval", training.validation_interval, "Epochs between validations");
  training_option("--seed", training.seed, "Of the weights and the order of rows");
  training_option("--symmetry", arguments.options.use_symmetry,
                  "See each chunk through the family's symmetries (1 or 0)");
}

void add_sample_options(CLI::App& command, TrainArguments& arguments) {
  auto& options = arguments.options;
  const auto sample_option = options_of(command, "Samples");
  sample_option("--least-energy", options.samples.min_energy, "MPa; rows below are left out");
  sample_option("--largest-energy", options.samples.max_energy, "MPa; rows above are left out");
  sample_option("--validation-share", options.split.validation, "Of the designs");
  sample_option("--test-share", options.split.test, "Of the designs");
  sample_option("--row-test-share", options.split.row_test, "Of the rows of the other designs");
  sample_option("--split-seed", options.split.seed, "Which designs and rows these are");
}

void add_options(CLI::App& command, TrainArguments& arguments) {
  auto& options = arguments.options;
  add_data_options(command, arguments.data);
  command.add_option("--out", arguments.out, "The model; until it is finished, OUT.partial keeps what is done")
      ->required();
  command.add_option("--start", arguments.start,
                     "A model of the same data and split: training goes on with it, and its network's shape holds");
  command.add_flag("--start-foreign", options.start_is_foreign,
                   "START was trained on other data of the family; what is held out now may have trained it");
  command.add_option("--rest-data", arguments.data.rest,
                     "Data sets of stiffnesses at rest (dataset rest), to which the stiffness branch is fitted first");
  command.add_option("--family", arguments.family, "Refuses data of another");
  command.add_option("--id", options.id, "Of the model; the family's unless given");
  command.add_option("--log", arguments.log, "CSV file of losses and validation errors");
  auto* exported = command.add_option("--export", arguments.exported,
                                      "Write the training for another trainer, as on a GPU, and train nothing");
  command
      .add_option("--import", arguments.imported,
                  "Take the network that it made, and write the model OUT; same options")
      ->excludes(exported);
  command.add_option("--threads", arguments.threads, "0: one for each core")->capture_default_str();
  command
      .add_option("--device", arguments.device,
                  "automatic: CUDA where LibTorch has a device; cpu; or cuda, an error elsewhere")
      ->check(CLI::IsMember({"automatic", "cpu", "cuda"}))
      ->capture_default_str();
  command.add_flag("--quiet", arguments.quiet, "No progress on stderr");
  add_network_options(command, arguments);
  add_training_options(command, arguments);
  add_sample_options(command, arguments);
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

struct ChangeArguments {
  std::filesystem::path model;
  DataArguments data;
  std::filesystem::path out;
};

void narrow(const ChangeArguments& arguments) {
  const auto model = training::narrowed(neural::read_model(arguments.model), read_data(arguments.data));
  neural::write_model(arguments.out, model);
  fmt::print("{} holds the model {} without error bars, for these parameters:\n", arguments.out.string(), model.id);
  for (long k = 0; k < model.network.lower.size(); ++k)
    fmt::print("{}: {:.6g} to {:.6g}\n", k + 1, model.network.lower[k], model.network.upper[k]);
}

void symmetrize(const ChangeArguments& arguments) {
  const auto model = training::symmetrized(neural::read_model(arguments.model), read_data(arguments.data));
  neural::write_model(arguments.out, model);
  fmt::print("{} holds the model {}, the mean over {} orientations of a strain\n", arguments.out.string(), model.id,
             model.network.symmetries.size() + 1);
  print_errors("design split", *model.design_split);
  print_errors("row split", *model.row_split);
}

struct CorrectArguments {
  std::filesystem::path model;
  DataArguments data;
  std::filesystem::path reference;
  std::filesystem::path out;
};

void correct_mesh(const CorrectArguments& arguments) {
  training::MeshCorrectionReport report;
  const auto model = training::with_mesh_correction(neural::read_model(arguments.model), read_data(arguments.data),
                                                    dataset::read_finished_or_partial(arguments.reference), report);
  neural::write_model(arguments.out, model);
  fmt::print("{} holds the model {} without error bars and with a correction of its data's mesh, from {} designs\n",
             arguments.out.string(), model.id, report.designs);
  const auto print = [](const char* what, const training::ModulusErrors& errors) {
    fmt::print(
        "{}: Young's moduli at rest are {:+.2f} % off in the mean; half are off by more than {:.2f} %, a tenth "
        "by more than {:.2f} %\n",
        what, 100 * errors.mean, 100 * errors.median, 100 * errors.percentile_90);
  };
  print("the mesh", report.uncorrected);
  print("corrected", report.corrected);
}

void add_correct_command(CLI::App& program) {
  const auto arguments = std::make_shared<CorrectArguments>();
  CLI::App* command = program.add_subcommand(
      "correct-mesh", "Take off what the mesh of a model's data errs by; calibrate the model afterwards");
  command->add_option("--model", arguments->model, "The model")->required();
  add_data_options(*command, arguments->data);
  command->add_option("--rest-data", arguments->data.rest, "Designs at rest on the mesh of the data (dataset rest)")
      ->required();
  command
      ->add_option("--reference", arguments->reference,
                   "The designs of --rest-data at rest on a mesh that errs by much less (dataset rest)")
      ->required();
  command->add_option("--out", arguments->out, "The corrected model")->required();
  command->callback([=] { correct_mesh(*arguments); });
}

struct CalibrateArguments {
  std::filesystem::path model;
  DataArguments data;
  std::vector<std::filesystem::path> drawn;
  std::vector<std::filesystem::path> searched;
  std::filesystem::path out;
  std::filesystem::path plot;
  int threads = 0;
};

void print_judged(neural::Quantity quantity, const neural::BarCoverage& judged) {
  fmt::print(
      "{}: {:.1f} % of {} states of {} designs that had no part in it within their bar, median {:.2f} %; of {} that "
      "err by more than "
      "3.57 %, {} are in range ({} without bars); of {} others, {} are not ({})\n",
      to_string(quantity), 100 * judged.share, judged.states, judged.designs, 100 * judged.median_bar, judged.beyond,
      judged.beyond_in_range, judged.beyond_in_box, judged.within, judged.within - judged.within_in_range,
      judged.within - judged.within_in_box);
}

void calibrate(const CalibrateArguments& arguments, const StopSignals& signals) {
  set_thread_count(arguments.threads);
  training::ReferenceData references;
  for (const auto& file : arguments.drawn) references.drawn.push_back(dataset::read_finished_or_partial(file));
  for (const auto& file : arguments.searched) references.searched.push_back(dataset::read_finished_or_partial(file));
  const auto result = training::calibrate(neural::read_model(arguments.model), read_data(arguments.data),
                                          signals.cancellation(), references);
  const auto& out = arguments.out.empty() ? arguments.model : arguments.out;
  neural::write_model(out, result.model);
  auto plot = arguments.plot;
  if (plot.empty()) plot = out.parent_path() / (out.stem().string() + "-calibration.svg");
  std::ofstream image(plot);
  image << training::calibration_plot(result);
  if (!image) throw Error("file.write_failed", "Cannot write " + plot.string() + ".");
  fmt::print("{} holds the model {} with error bars of {:.0f} %; {} shows them\n", out.string(), result.model.id,
             100 * result.model.calibration->level, plot.string());
  for (const auto quantity : neural::all_quantities)
    print_judged(quantity, result.model.calibration->of(quantity).given.judged);
  if (references.searched.empty()) return;
  fmt::print("Of designs that searches have found:\n");
  for (const auto quantity : neural::all_quantities)
    print_judged(quantity, result.model.calibration->of(quantity).searched.judged);
}

void add_calibrate_command(CLI::App& program, const StopSignals& signals) {
  const auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = program.add_subcommand(
      "calibrate", "Give a model error bars for each of its answers, by its data or by --reference");
  command->add_option("--model", arguments->model, "The model")->required();
  add_data_options(*command, arguments->data);
  command->add_option("--reference", arguments->drawn,
                      "States that judge instead of held-out ones: designs drawn at random, simulated as users do");
  command->add_option("--searched", arguments->searched,
                      "States of designs that searches have found, which get bars of their own");
  command->add_option("--out", arguments->out, "The model with error bars; MODEL itself unless given");
  command->add_option("--plot", arguments->plot,
                      "Picture of stated and observed shares, as SVG; OUT-calibration.svg unless given");
  command->add_option("--threads", arguments->threads, "0: one for each core")->capture_default_str();
  command->callback([=, &signals] { calibrate(*arguments, signals); });
}

/// Adds a command that changes a model with the data on which it was trained, and writes the result.
void add_change_command(CLI::App& program, const char* name, const char* about, const char* out,
                        void (*change)(const ChangeArguments&)) {
  const auto arguments = std::make_shared<ChangeArguments>();
  CLI::App* command = program.add_subcommand(name, about);
  command->add_option("--model", arguments->model, "The model")->required();
  add_data_options(*command, arguments->data);
  command->add_option("--out", arguments->out, out)->required();
  command->callback([=] { change(*arguments); });
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

}  // namespace

void add_model_commands(CLI::App& program, const StopSignals& signals, bool& interrupted) {
  add_train_command(program, signals, interrupted);
  add_change_command(
      program, "symmetrize",
      "Give a model the rotations of its family exactly, at two or three times the time of an evaluation",
      "The model with its errors measured anew", symmetrize);
  add_change_command(program, "narrow", "Let a model's bounds end where its data end; calibrate it afterwards",
                     "The model with the narrower bounds", narrow);
  add_correct_command(program);
  add_calibrate_command(program, signals);
  add_card_command(program);
}

}  // namespace supple::lab
