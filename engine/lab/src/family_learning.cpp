#include "supple/lab/family_learning.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "supple/base/durable_file.h"
#include "supple/base/error.h"
#include "supple/dataset/dataset_file.h"
#include "supple/lab/dataset_maker.h"
#include "supple/lab/design_choice.h"
#include "supple/lab/engine_version.h"
#include "supple/neural/model.h"
#include "supple/tiling/definition_text.h"
#include "supple/training/model_calibration.h"
#include "supple/training/model_card.h"
#include "supple/training/model_training.h"

namespace supple::lab {
namespace {

namespace fs = std::filesystem;

/// Designs with states that are needed at least, so that some are held out.
constexpr std::int64_t min_simulated_designs = 20;
/// Held-out designs, if all even designs can be simulated and are within the bounds.
constexpr double min_test_designs = 6;
constexpr double min_validation_designs = 3;

/// When a file was last written; nothing if it does not exist.
std::optional<fs::file_time_type> time_of(const fs::path& path) {
  std::error_code error;
  const auto time = fs::last_write_time(path, error);
  return error ? std::nullopt : std::optional(time);
}

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error("file.unreadable", "The file " + path.string() + " cannot be read.");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Ends a run that was asked to stop.
struct Stopped {};

/// A process that was asked to end may still have the folder for so long.
constexpr std::chrono::seconds max_lock_wait{30};
constexpr std::chrono::milliseconds between_lock_attempts{100};

/// A lock on a folder, which ends with the process.
class FolderLock {
 public:
  FolderLock(const fs::path& folder, const CancellationToken& cancellation) {
    const auto path = folder / "lock";
    descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor_ < 0)
      throw Error("file.write_failed", "Cannot open " + path.string() + ": " + std::strerror(errno) + ".");
    const auto end = std::chrono::steady_clock::now() + max_lock_wait;
    do {
      if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
      std::this_thread::sleep_for(between_lock_attempts);
    } while (!cancellation.requested() && std::chrono::steady_clock::now() < end);
    ::close(descriptor_);
    if (cancellation.requested()) throw Stopped();
    throw Error("dataset.in_use", "Another process makes a network in " + folder.string() + ".");
  }
  ~FolderLock() { ::close(descriptor_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

/// Everything on which a run depends, a line each.
std::string describe(const LearningOptions& options) {
  std::ostringstream text;
  text.precision(17);
  const auto& plan = options.plan;
  text << "even_designs " << plan.even_designs << "\nrounds " << plan.rounds << "\nround_designs " << plan.round_designs
       << "\nmembers " << plan.members << "\nmember_width " << plan.member_width << "\nmember_epochs "
       << plan.member_epochs << "\nwidth " << plan.width << "\nepochs " << plan.epochs << "\nerror " << options.error
       << "\nid " << options.id << "\n";
  auto data = options.data;
  data.first = 0;
  data.designs = 1;
  const auto recipe = recipe_of(data);
  for (const auto& setting : recipe.settings())
    text << setting.name << " " << dataset::to_string(setting.value) << "\n";
  return text.str();
}

/// Passes the progress of a data set on.
class DesignProgress : public MakeListener {
 public:
  DesignProgress(std::function<void(double)> report, std::function<void()> saved)
      : report_(std::move(report)), saved_(std::move(saved)) {}

  void started(std::int64_t designs, std::int64_t already_finished, std::int64_t /*states*/) override {
    designs_ = designs;
    done_ = already_finished;
  }
  void state_reached() override {}
  void design_done(const dataset::Design& /*design*/) override {
    saved_();
    report_(static_cast<double>(++done_) / static_cast<double>(std::max<std::int64_t>(1, designs_)));
  }

 private:
  std::function<void(double)> report_;
  std::function<void()> saved_;
  std::int64_t designs_ = 1;
  std::int64_t done_ = 0;
};

/// Designs of a list, as text that gives the same numbers again.
std::string text_of(const std::vector<std::vector<double>>& designs) {
  std::string text;
  for (const auto& parameters : designs) text += dataset::to_string(dataset::Recipe::Value(parameters)) + "\n";
  return text;
}

std::vector<double> numbers_in(const fs::path& path) {
  auto text = content_of(path);
  std::replace(text.begin(), text.end(), '\n', ',');
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || next == end || *next != ',')
      throw Error("file.unreadable", "The file " + path.string() + " is no list of designs.");
    numbers.push_back(value);
    at = next + 1;
  }
  return numbers;
}

class LearningRun {
 public:
  LearningRun(const LearningOptions& options, fs::path folder, const CancellationToken& cancellation,
              LearningListener* listener)
      : options_(options),
        plan_(options.plan),
        folder_(std::move(folder)),
        cancellation_(cancellation),
        listener_(listener) {}

  LearningResult run() {
    try {
      fs::create_directories(folder_);
      const FolderLock lock(folder_, cancellation_);
      check_folder();
      simulate(0, {});
      require_designs();
      for (int round = 1; round <= plan_.rounds && !is_good_enough_; ++round) simulate(round, choose(round));
      finish();
    } catch (const Stopped&) {
      result_.finished = false;
    }
    return result_;
  }

 private:
  /// Writes the options into a new folder, and refuses one of other options.
  void check_folder() {
    const auto path = folder_ / "options.txt";
    const auto wanted = describe(options_);
    if (!fs::exists(path)) return write_atomically(path, {wanted});
    if (content_of(path) == wanted) return;
    throw Error("dataset.different_recipe",
                "The folder " + folder_.string() + " has a run of other options; " + path.string() + " lists them.");
  }

  void report(const std::string& stage, double done_of_stage, double stage_share) {
    if (listener_) listener_->progress(done_ + stage_share * done_of_stage, stage);
  }
  void end_stage(const std::string& stage, double stage_share) {
    done_ += stage_share;
    if (listener_) listener_->progress(done_, stage);
    if (cancellation_.requested()) throw Stopped();
  }

  /// Makes the data set of a round: the even designs, or those of a list.
  void simulate(int round, const std::vector<double>& list) {
    auto data = options_.data;
    data.first = 0;
    data.shard = 0;
    data.shards = 1;
    data.designs = round == 0 ? plan_.even_designs : static_cast<std::int64_t>(list.size() / parameters());
    data.list = list;
    const double share = simulation_share(round);
    if (data.designs > 0) {
      const auto path = folder_ / ("round-" + std::to_string(round) + ".h5");
      DesignProgress progress([&](double done) { report("designs", done, share); }, [&] { note_saved(); });
      if (!make_dataset(data, path, cancellation_, &progress).finished) throw Stopped();
      sets_.push_back(dataset::read_dataset(path));
      for (const auto& design : sets_.back().designs) result_.designs += design.rows.empty() ? 0 : 1;
    }
    end_stage("designs", share);
  }

  /// Trains the committee of a round, and chooses its designs.
  std::vector<double> choose(int round) {
    const auto path = folder_ / ("choice-" + std::to_string(round) + ".txt");
    std::vector<neural::Model> members;
    for (int member = 0; member < plan_.members; ++member) members.push_back(committee_member(round, member));
    double error = 0;
    for (const auto& member : members) error += neural::mean_stress_error(member).value_or(1) / plan_.members;
    note_error(error);
    if (options_.error > 0 && error <= options_.error) {
      is_good_enough_ = true;
      return {};
    }
    if (!fs::exists(path)) {
      ChoiceOptions choice;
      choice.designs = static_cast<int>(plan_.round_designs);
      choice.seed = options_.data.seed;
      choice.first = static_cast<std::uint32_t>((round - 1) * choice.candidates);
      write_atomically(path, {text_of(choose_designs(family_of(options_.data), members, sets_, choice))});
    }
    return numbers_in(path);
  }

  neural::Model committee_member(int round, int member) {
    const auto name = "committee-" + std::to_string(round) + "-" + std::to_string(member);
    return train(name, plan_.member_width, plan_.member_epochs, member + 1, "committee",
                 committee_share() / plan_.members);
  }

  /// Trains a network on all data so far, or reads it where that is done. The network is in the file NAME.h5.
  neural::Model train(const std::string& name, int width, int epochs, std::int64_t seed, const std::string& stage,
                      double share) {
    const auto path = folder_ / (name + ".h5");
    const auto checkpoint = folder_ / (name + ".partial");
    if (!fs::exists(path)) {
      training::ModelOptions options;
      options.id = options_.id;
      options.use_features = has_features();
      options.split = held_out();
      options.training.shape.width = width;
      options.training.epochs = epochs;
      options.training.seed = seed;
      options.training.device = training::DeviceKind::cpu;
      auto written = time_of(checkpoint);
      const auto result = training::train_model(data(), name_of_data(), engine_version(), options, checkpoint,
                                                cancellation_, [&](const training::EpochReport& epoch) {
                                                  report(stage, static_cast<double>(epoch.epoch) / epochs, share);
                                                  if (std::exchange(written, time_of(checkpoint)) != written)
                                                    note_saved();
                                                });
      if (!result.finished) throw Stopped();
      neural::write_model(path, result.model);
      note_saved();
    }
    fs::remove(checkpoint);
    end_stage(stage, share);
    return neural::read_model(path);
  }

  void finish() {
    const auto path = folder_ / "model.h5";
    if (!fs::exists(path)) {
      auto model = train("network", plan_.width, plan_.epochs, 1, "network", network_share());
      model = symmetrized_if_better(std::move(model));
      auto calibrated = training::calibrate(std::move(model), data(), cancellation_);
      if (cancellation_.requested()) throw Stopped();
      std::ofstream(folder_ / "model-calibration.svg") << training::calibration_plot(calibrated);
      write_atomically(folder_ / "model.md", {training::model_card(calibrated.model, data(), "model-calibration.svg")});
      // The same run gives the same bytes, however often it was stopped. The card says how long the training took.
      calibrated.model.provenance.training_seconds = 0;
      // The model comes last, since it says that everything is done.
      neural::write_model(path, calibrated.model);
    }
    const auto model = neural::read_model(path);
    result_.model = path;
    result_.error = neural::mean_stress_error(model).value_or(1);
    result_.finished = true;
    note_error(result_.error);
    if (listener_) listener_->progress(1, "error bars");
  }

  /// The energy that is the mean over the rotations of the tilings, if it errs less than the network alone.
  neural::Model symmetrized_if_better(neural::Model model) {
    try {
      auto symmetric = training::symmetrized(model, data());
      if (neural::mean_stress_error(symmetric).value_or(1) < neural::mean_stress_error(model).value_or(1))
        return symmetric;
    } catch (const Error& error) {
      if (error.code() != "training.no_symmetry") throw;
    }
    return model;
  }

  void require_designs() {
    if (result_.designs >= min_simulated_designs) return;
    std::string why;
    for (const auto& design : sets_.front().designs)
      if (why.empty() && !design.error_message.empty()) why = " The first that failed: " + design.error_message;
    throw Error("training.too_few_designs", "Only " + std::to_string(result_.designs) + " of " +
                                                std::to_string(plan_.even_designs) + " designs can be simulated, and " +
                                                std::to_string(min_simulated_designs) + " are needed." + why);
  }

  void note_saved() {
    if (listener_) listener_->saved();
  }
  void note_error(double error) {
    if (listener_) listener_->error_reached(error, result_.designs);
  }

  training::ModelData data() const { return {sets_.front(), {sets_.begin() + 1, sets_.end()}, {}}; }
  std::string name_of_data() const {
    std::string names;
    for (std::size_t i = 0; i < sets_.size(); ++i) names += (i > 0 ? " " : "") + ("round-" + std::to_string(i) + ".h5");
    return names;
  }
  std::size_t parameters() const { return family_of(options_.data).parameters.size(); }
  /// The designs that judge the networks and calibrate their error bars are among the even ones. They are a larger part
  /// of few designs.
  training::SplitOptions held_out() const {
    const auto designs = static_cast<double>(plan_.even_designs);
    training::SplitOptions split;
    split.test = std::max(split.test, min_test_designs / designs);
    split.validation = std::max(split.validation, min_validation_designs / designs);
    return split;
  }
  /// Whether networks can read features of the tile, which must be one polygon.
  bool has_features() const { return family_of(options_.data).definition != nullptr; }

  // The shares of the stages in what the progress reports, about as they share the time.
  double designs_of(int round) const {
    return static_cast<double>(round == 0 ? plan_.even_designs : plan_.round_designs);
  }
  double simulation_share(int round) const {
    return 0.6 * designs_of(round) / static_cast<double>(plan_.even_designs + plan_.rounds * plan_.round_designs);
  }
  double committee_share() const { return 0.15 / std::max(1, plan_.rounds); }
  double network_share() const { return plan_.rounds > 0 ? 0.23 : 0.38; }

  const LearningOptions& options_;
  const LearningPlan& plan_;
  const fs::path folder_;
  const CancellationToken& cancellation_;
  LearningListener* const listener_;
  std::vector<dataset::Dataset> sets_;
  LearningResult result_;
  double done_ = 0;
  bool is_good_enough_ = false;
};

}  // namespace

LearningResult learn_family(const LearningOptions& options, const fs::path& folder,
                            const CancellationToken& cancellation, LearningListener* listener) {
  check(options.data);
  return LearningRun(options, folder, cancellation, listener).run();
}

}  // namespace supple::lab
