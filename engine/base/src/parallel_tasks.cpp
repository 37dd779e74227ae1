#include "supple/base/parallel_tasks.h"

#include <mutex>

#include "supple/base/threads.h"

namespace supple {

std::vector<CostLedger> parallel_bills(int n, const Execution& execution, std::string_view stage,
                                       const std::function<void(int, const Execution&)>& task) {
  std::vector<CostLedger> bills(static_cast<std::size_t>(n));
  std::mutex reporting;
  int done = 0;
  parallel_for(n, [&](int i) {
    execution.cancellation.throw_if_requested();
    task(i, {execution.cancellation, nullptr, execution.cost ? &bills[static_cast<std::size_t>(i)] : nullptr});
    if (!execution.progress) return;
    const std::lock_guard lock(reporting);
    execution.progress->report(static_cast<double>(++done) / n, stage);
  });
  return bills;
}

void parallel_tasks(int n, const Execution& execution, std::string_view stage,
                    const std::function<void(int, const Execution&)>& task) {
  const std::vector<CostLedger> bills = parallel_bills(n, execution, stage, task);
  if (!execution.cost) return;
  for (const CostLedger& bill : bills) execution.cost->merge(bill);
}

}  // namespace supple
