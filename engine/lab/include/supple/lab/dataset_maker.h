#pragma once

#include <cstdint>
#include <filesystem>

#include "supple/base/cancellation.h"
#include "supple/dataset/dataset.h"
#include "supple/lab/dataset_options.h"
#include "supple/lab/design_simulation.h"

namespace supple::lab {

/// Is told how far a data set has come, by the threads that compute it. Calls of `design_done` come one at a time.
class MakeListener : public StateListener {
 public:
  /// Called once, before the first design: how many designs are asked for, how many an earlier run has finished, and
  /// how many states each of the others has.
  virtual void started(std::int64_t designs, std::int64_t found, std::int64_t states_per_design) = 0;
  virtual void design_done(const dataset::Design& design) = 0;
};

struct MakeResult {
  std::int64_t designs = 0;   ///< number of designs that the file or journal holds now
  std::int64_t computed = 0;  ///< number of them that this run computed
  bool finished = false;      ///< whether `path` is complete
};

/// Makes the data set `path` on all counted threads. Each thread computes one design at a time.
///
/// Finished designs are kept in a journal beside `path` (see dataset::Journal) and survive a kill at any moment. The
/// same call goes on from there. When all designs are finished, `path` appears at once and the journal is deleted. A
/// stop request drops the unfinished designs and returns. A `path` that is complete already is left as it is. The rows
/// do not depend on the number of threads, on the shard, or on interruptions. Throws what `check` throws, and the
/// errors of Journal and write_dataset.
MakeResult make_dataset(const DatasetOptions& options, const std::filesystem::path& path,
                        const CancellationToken& cancellation = {}, MakeListener* listener = nullptr);

struct RenewOptions {
  /// A design is simulated anew if one of its probes deviates by more than this share of the stress. Another mesh of
  /// the same size changes the stress by 0.3 % in the mean.
  double tolerance = 2e-3;
  /// Whether designs with states in contact are simulated anew in any case, because the probes are next to rest.
  bool contacts = false;
};

struct RenewResult {
  std::int64_t designs = 0;  ///< number of designs that the file or journal holds now
  std::int64_t renewed = 0;  ///< number of them that this run simulated anew; the others are as they were
  bool finished = false;     ///< whether `path` is complete
};

/// Makes the data set `path` from the finished one `old`, for the engine as it is now. It has the same recipe and
/// designs. Designs whose response has changed are simulated anew. The first state of the first path of each kind of
/// load decides whether it has changed. Designs that the engine had refused, or with paths that failed, are always
/// simulated anew. Each design keeps the version of the engine that computed it.
///
/// Interruptions, journal and threads are as in `make_dataset`. Throws "dataset.invalid_option",
/// "dataset.different_recipe" if the engine's family has other bounds or another beam width than the recipe, and what
/// `make_dataset` throws.
RenewResult renew_dataset(const dataset::Dataset& old, const RenewOptions& options, const std::filesystem::path& path,
                          const CancellationToken& cancellation = {}, MakeListener* listener = nullptr);

}  // namespace supple::lab
