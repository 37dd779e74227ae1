#pragma once

#include <string>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

/// Finds what is likely to be a mistake in a valid weave. Each warning is a sentence with the index of the first
/// example. There are warnings of strands that nothing connects or that fall into several parts, of places where
/// strands cross without a crossing, of crossings at angles below 0.2 rad (where the overlap is too long to be a
/// point), and of crossings that are closer together on a strand than its diameter. A weave with warnings can be
/// computed all the same. Costs what `find_crossings` costs. Throws if a stop is requested.
std::vector<std::string> layout_warnings(const Weave& weave, const Execution& execution = {});

}  // namespace supple::weave
