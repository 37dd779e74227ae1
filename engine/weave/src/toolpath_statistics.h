#pragma once

#include <vector>

#include "supple/weave/toolpath.h"

namespace supple::weave {

ToolpathStatistics statistics(const std::vector<Move>& moves, const PrinterProfile& profile);

}  // namespace supple::weave
