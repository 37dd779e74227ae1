#include "supple/base/parallel_tasks.h"

#include <mutex>

#include "supple/base/threads.h"

namespace supple {
namespace {

void merge_all(const std::vector<CostLedger>& bills, CostLedger* into) {
  if (!into) return;
  for (const CostLedger& bill : bills) into->merge(bill);
}

}  // namespace

std::vector<CostLedger> parallel_bills(int n, const Execution& execution, std::string_view stage,
                                       const std::function<void(int, const Execution&)>& task) {
  std::vector<CostLedger> bills(static_cast<std::size_t>(n));
  std::mutex reporting;
  int done = 0;
  try {
    parallel_for(n, [&](int i) {
      execution.cancellation.throw_if_requested();
      task(i, {execution.cancellation, nullptr, execution.cost ? &bills[static_cast<std::size_t>(i)] : nullptr});
      if (!execution.progress) return;
      const std::lock_guard lock(reporting);
      execution.progress->report(static_cast<double>(++done) / n, stage);
    });
  } catch (...) {
    // Every task that began has ended here, since parallel_for waits for them.
    merge_all(bills, execution.cost);
    throw;
  }
  return bills;
}

void parallel_tasks(int n, const Execution& execution, std::string_view stage,
                    const std::function<void(int, const Execution&)>& task) {
  merge_all(parallel_bills(n, execution, stage, task), execution.cost);
}

}  // namespace supple
