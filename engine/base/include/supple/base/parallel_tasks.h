#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"

namespace supple {

/// Runs task(i, execution of its own) for i in [0, n), in parallel within the counted threads. Returns a bill for each,
/// in order, so that what is merged does not depend on which thread was first. Looks for a stop request before each
/// task and reports the share of tasks that are done. Of several exceptions one reaches the caller; what was billed
/// until then is merged into the execution's bill, in order, since nothing is returned.
std::vector<CostLedger> parallel_bills(int n, const Execution& execution, std::string_view stage,
                                       const std::function<void(int, const Execution&)>& task);

/// The same, with all bills merged into the execution's.
void parallel_tasks(int n, const Execution& execution, std::string_view stage,
                    const std::function<void(int, const Execution&)>& task);

}  // namespace supple
