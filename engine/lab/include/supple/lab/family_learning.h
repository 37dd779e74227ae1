#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "supple/base/cancellation.h"
#include "supple/lab/dataset_options.h"

namespace supple::lab {

/// How a network of a family is made: which designs are simulated, and how long networks learn from them.
struct LearningPlan {
  std::int64_t even_designs = 120;  ///< spread evenly over the box; some of them judge the networks
  int rounds = 3;                   ///< of designs that a committee of small networks chooses; 0: even designs alone
  std::int64_t round_designs = 60;
  int members = 3;        ///< networks of a committee, 2 or more
  int member_width = 32;  ///< a multiple of 16
  int member_epochs = 120;
  int width = 96;  ///< of the network, a multiple of 16
  int epochs = 300;

  bool operator==(const LearningPlan&) const = default;
};

/// What is known of the time that a plan takes, in core-seconds.
struct LearningCost {
  double simulation = 0;
  double training = 0;

  double total() const { return simulation + training; }
};

/// The time that a plan takes if one design takes `design_seconds` and has `states` states.
LearningCost cost_of(const LearningPlan& plan, double design_seconds, int states);

/// The plan that makes the most of this many core-seconds. Throws "training.small_budget", which says how many are
/// needed, if not even the smallest plan is done within them.
LearningPlan plan_within(double core_seconds, double design_seconds, int states, int parameters);

/// The mean time of a design of the data set, in core-seconds, from four designs of its sequence that are simulated for
/// it. Throws "training.too_few_designs" if none of them can be.
double design_seconds(const DatasetOptions& options, const CancellationToken& cancellation = {});

/// The states of a design of the data set, if all are reached.
int states_of(const DatasetOptions& options);

struct LearningOptions {
  DatasetOptions data;  ///< family, seed, loads and simulation; the plan says which designs there are
  LearningPlan plan;
  /// Mean relative error of the stress on designs that were held out. Once a committee has it, no further designs are
  /// chosen. 0 for none.
  double error = 0;
  std::string id;  ///< of the model; if empty, the family's id in lower case
};

/// Listens to the progress of a run, on the thread that runs it and on those that simulate, one at a time.
class LearningListener {
 public:
  virtual ~LearningListener() = default;
  /// `fraction` of the run is done; `stage` is "designs", "committee", "network" or "error bars".
  virtual void progress(double fraction, const std::string& stage) = 0;
  /// Something new has been written with which the next start goes on.
  virtual void saved() {}
  /// The mean relative error of the stress that was measured on designs held out of the last networks.
  virtual void error_reached(double error, std::int64_t designs) = 0;
};

struct LearningResult {
  std::filesystem::path model;  ///< the finished model; its card is beside it
  double error = 0;             ///< mean relative error of its stress on designs held out
  std::int64_t designs = 0;     ///< that were simulated
  bool finished = false;        ///< false if it was stopped; the same call goes on
};

/// Goes from a family to a network: simulates designs that are spread evenly over the box of parameters, lets a
/// committee of small networks choose further ones, trains the network on all of them, makes its energy symmetric where
/// that errs less, gives it error bars, and writes its card.
///
/// Everything lies in `folder`, a file for each step, which appears when the step is done: "round-0.h5", then for each
/// round "committee-K-M.h5", "choice-K.txt" and "round-K.h5", then "model.h5" and "model.md". Unfinished steps have
/// journals and checkpoints. So the same call goes on after a kill at any moment, and ends with a model of the same
/// bytes, which therefore has no time of its training; its card has. One process at a time uses a folder.
///
/// Throws "dataset.different_recipe" for a folder of other options, "training.too_few_designs" if hardly any design can
/// be simulated, and what `make_dataset`, `training::train_model` and `training::calibrate` throw.
LearningResult learn_family(const LearningOptions& options, const std::filesystem::path& folder,
                            const CancellationToken& cancellation = {}, LearningListener* listener = nullptr);

}  // namespace supple::lab
