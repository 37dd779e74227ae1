#pragma once

#include <string>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

/// What of a valid weave is likely to be a mistake, one sentence each, with the first example's index: strands that
/// nothing connects or that fall into several parts, places where strands cross without a crossing, crossings at angles
/// below 0.2 rad (the bigger the overlap, the less it is a point), and crossings closer together on a strand than its
/// diameter. None of it keeps a weave from being computed. Costs what `find_crossings` costs;
/// stops where a stop is requested.
std::vector<std::string> layout_warnings(const Weave& weave, const Execution& execution = {});

}  // namespace supple::weave
