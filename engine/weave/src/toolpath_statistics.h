#pragma once

#include <vector>

#include "supple/weave/toolpath.h"

namespace supple::weave {

/// Totals of the moves of a toolpath. O(points).
ToolpathStatistics statistics(const std::vector<Move>& moves, const PrinterProfile& profile);

}  // namespace supple::weave
