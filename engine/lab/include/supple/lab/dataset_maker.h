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

}  // namespace supple::lab
