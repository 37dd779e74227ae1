#pragma once

#include <string>

#include "supple/base/error.h"
#include "supple/base/execution.h"
#include "supple/json/weave_answers.h"
#include "supple/json/weave_requests.h"

namespace supple::routes {

/// What pictures of weaves and toolpaths are sent as.
inline constexpr const char* svg_type = "image/svg+xml";

/// The weave that a request means. Throws "weave.invalid_strand", "weave.invalid_layout" and "weave.invalid_pattern"
/// with pointers into the request. Crossings may be many: it belongs into the computation, and stops as that does.
weave::Weave make_weave(const json::WeaveSpec& spec, const Execution& execution);

/// Throws what `make_weave` throws where that takes some milliseconds at most: patterns of few strands and a few
/// straight strands. Of others only the computation tells.
void refuse_small_faulty_weave(const json::WeaveSpec& spec);

/// Where the engine's supports came from, beside them.
struct PlacedLoad {
  weave::SheetLoad load;
  std::vector<json::HeldPlace> places;  ///< one for each support
  std::vector<int> force_of;            ///< the request's force of each of the engine's
};

/// The places of a request on the weave: boxes become what lies within them. Throws "weave.invalid_load" with pointers
/// where a place does not exist or a box is empty, "request.limit_exceeded" for more places than a load may have.
/// O(crossings + strands) for each box; stops where a stop is requested.
PlacedLoad place_load(const json::WeaveSimulationRequest& request, const weave::Weave& weave,
                      const json::Limits& limits, const Execution& execution);

/// A fault of the engine's load as one of the request's: "supports/7/clamped" becomes "/supports/2/clamped".
Error moved_to_request(const Error& error, const PlacedLoad& placed);

}  // namespace supple::routes
