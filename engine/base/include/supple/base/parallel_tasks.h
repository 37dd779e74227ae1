#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"

namespace supple {

/// Runs task(i, its own execution) for i in [0, n), in parallel within the counted threads. Returns a bill for each
/// task, in order, so that merged bills do not depend on which thread was first. Checks for a stop request before each
/// task, and reports the fraction of finished tasks. If there are several exceptions, one of them reaches the caller.
/// What was billed until then is merged into the execution's bill, in order, because nothing is returned.
std::vector<CostLedger> parallel_bills(int n, const Execution& execution, std::string_view stage,
                                       const std::function<void(int, const Execution&)>& task);

/// Does the same, and merges all bills into that of the execution.
void parallel_tasks(int n, const Execution& execution, std::string_view stage,
                    const std::function<void(int, const Execution&)>& task);

}  // namespace supple
