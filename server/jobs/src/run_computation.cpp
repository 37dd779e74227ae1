#include "run_computation.h"

#include "supple/base/watched_work.h"
#include "supple/budget/computation_memory.h"

namespace supple::jobs {

store::Result run_computation(const Computation& computation, const Execution& execution, budget::MemoryBudget* memory,
                              Profile* profile) {
  const WatchedWork watched;
  if (!memory) return computation.run(execution);
  budget::ComputationMemory account(*memory, execution.cancellation);
  struct NotePeak {
    const budget::ComputationMemory& account;
    Profile* profile;
    ~NotePeak() {
      if (profile) profile->peak_memory = account.peak();
    }
  } const note{account, profile};
  try {
    const MemoryAccount::Use use(&account);
    return computation.run(execution);
  } catch (const Cancelled& stop) {
    // What is reported where memory has run out may be stopped for another reason.
    if (stop.reason() == StopReason::memory) account.throw_if_stopped();
    throw;
  } catch (...) {
    // A computation without memory may also end with a lack of memory, or with an error that follows from it.
    account.throw_if_stopped();
    throw;
  }
}

store::Result charge_request(store::Result result) {
  budget::reserve(static_cast<std::int64_t>(result.body.size()), "its answer");
  return result;
}

}  // namespace supple::jobs
