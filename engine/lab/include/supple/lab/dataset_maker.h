#pragma once

#include <cstdint>
#include <filesystem>

#include "supple/base/cancellation.h"
#include "supple/dataset/dataset.h"
#include "supple/lab/dataset_options.h"
#include "supple/lab/design_simulation.h"

namespace supple::lab {

/// Hears how far a data set has come, from the threads that compute it, one call at a time for `design_done`.
class MakeListener : public StateListener {
 public:
  /// Once, before the first design: how many are asked for, how many an earlier run has left, and how many states each
  /// of the others has.
  virtual void started(std::int64_t designs, std::int64_t found, std::int64_t states_per_design) = 0;
  virtual void design_done(const dataset::Design& design) = 0;
};

struct MakeResult {
  std::int64_t designs = 0;   ///< that the file or journal holds now
  std::int64_t computed = 0;  ///< of them, in this run
  bool finished = false;      ///< whether `path` is complete
};

/// Makes the data set `path`, on all counted threads, one design for each at a time.
///
/// Designs that are done are kept in a journal beside `path` (see dataset::Journal) and survive a kill at any moment;
/// the same call goes on from there. When all are done, `path` appears at once and the journal goes. A request to stop
/// drops the designs at work and returns. A `path` that is complete already is left as it is. Its rows do not depend on
/// the number of threads, on the shard, or on interruptions. Throws what `check` throws, and the errors of Journal and
/// write_dataset.
MakeResult make_dataset(const DatasetOptions& options, const std::filesystem::path& path,
                        const CancellationToken& cancellation = {}, MakeListener* listener = nullptr);

struct RenewOptions {
  /// A design is simulated anew where one of its probes deviates by more than this share of the stress: above what
  /// another mesh of the same size makes, 0.3 % at the mean.
  double tolerance = 2e-3;
  /// Whether designs with states in contact are simulated anew in any case: the probes are next to rest.
  bool contacts = false;
};

struct RenewResult {
  std::int64_t designs = 0;  ///< that the file or journal holds now
  std::int64_t renewed = 0;  ///< of them simulated anew in this run; the others are as they were
  bool finished = false;     ///< whether `path` is complete
};

/// Makes the data set `path` of the finished one `old`, for the engine as it is now: with the same recipe and the
/// designs that it holds, of which those are simulated anew whose response has changed. Whether it has is asked of the
/// first state of the first path of each kind of load; designs that the engine had refused, or with paths that failed,
/// are simulated anew. Each design keeps the version of the engine that computed it.
///
/// Interruptions, journal and threads as with `make_dataset`. Throws "dataset.invalid_option",
/// "dataset.different_recipe" where the engine's family has other bounds or another beam width than the recipe, and
/// what `make_dataset` throws.
RenewResult renew_dataset(const dataset::Dataset& old, const RenewOptions& options, const std::filesystem::path& path,
                          const CancellationToken& cancellation = {}, MakeListener* listener = nullptr);

}  // namespace supple::lab
