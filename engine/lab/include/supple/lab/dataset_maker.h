#pragma once

#include <cstdint>
#include <filesystem>

#include "supple/base/cancellation.h"
#include "supple/dataset/dataset.h"
#include "supple/lab/dataset_options.h"
#include "supple/lab/design_simulation.h"

namespace supple::lab {

/// Listens to the progress of a data set. It is called by the threads that compute it; calls of `design_done` never
/// overlap.
class MakeListener : public StateListener {
 public:
  /// Called once, before the first design, with the number of requested designs, the number of those that an earlier
  /// run has finished, and the number of states of each of the others.
  virtual void started(std::int64_t designs, std::int64_t already_finished, std::int64_t states_per_design) = 0;
  virtual void design_done(const dataset::Design& design) = 0;
};

struct MakeResult {
  std::int64_t designs = 0;   ///< number of designs that the file or journal holds now
  std::int64_t computed = 0;  ///< number of them that this run computed
  bool finished = false;      ///< whether `path` is complete
};

/// Makes the data set `path` on thread_count() threads. Each thread computes one design at a time.
///
/// Finished designs are stored in a journal beside `path` (see dataset::Journal) and survive a kill at any moment. The
/// same call then continues. When all designs are finished, `path` is written atomically and the journal is deleted. A
/// stop request drops the unfinished designs and returns. A `path` that is complete already is not changed. The rows do
/// not depend on the number of threads, on the shard, or on interruptions. Throws what `check` throws, and the errors
/// of Journal and write_dataset.
MakeResult make_dataset(const DatasetOptions& options, const std::filesystem::path& path,
                        const CancellationToken& cancellation = {}, MakeListener* listener = nullptr);

struct RenewOptions {
  /// A design is simulated anew if the stress of one of the states that are computed for comparison has changed by more
  /// than this fraction. For comparison, another mesh of the same size changes the stress by 0.3 % in the mean.
  double tolerance = 2e-3;
  /// Whether designs with states in contact are simulated anew in any case. The states that are compared have small
  /// strains, where beams do not touch yet.
  bool contacts = false;
};

struct RenewResult {
  std::int64_t designs = 0;  ///< number of designs that the file or journal holds now
  std::int64_t renewed = 0;  ///< number of them that this run simulated anew; the others are copied
  bool finished = false;     ///< whether `path` is complete
};

/// Updates the finished data set `old` to the present engine, and writes it to `path`. It has the same recipe and
/// designs. For each design the first state of the first path of each kind of load is computed and compared. The design
/// is simulated anew if one has changed. Designs that the engine had rejected, or with paths that failed, are always
/// simulated anew. Each design records the version of the engine that computed it.
///
/// Interruptions, journal and threads are as in `make_dataset`. Throws "dataset.invalid_option",
/// "dataset.different_recipe" if the engine's family has other bounds or another beam width than the recipe, and what
/// `make_dataset` throws.
RenewResult renew_dataset(const dataset::Dataset& old, const RenewOptions& options, const std::filesystem::path& path,
                          const CancellationToken& cancellation = {}, MakeListener* listener = nullptr);

}  // namespace supple::lab
