#pragma once

#include <string>

#include "request_pointers.h"
#include "supple/base/execution.h"
#include "supple/json/weave_answers.h"
#include "supple/json/weave_requests.h"

namespace supple::routes {

/// Media type of pictures of weaves and toolpaths.
inline constexpr const char* svg_type = "image/svg+xml";

/// The weave that a request means. Throws "weave.invalid_strand", "weave.invalid_layout" and "weave.invalid_pattern"
/// with pointers into the request, and the error of a stop request. It belongs into the computation, for a weave may
/// have many crossings.
weave::Weave make_weave(const json::WeaveSpec& spec, const Execution& execution);

/// Throws what `make_weave` throws, if that takes some milliseconds at most: for patterns of few strands, and for a few
/// straight strands. The faults of other weaves are found by the computation.
void refuse_small_faulty_weave(const json::WeaveSpec& spec);

/// A load of the engine, and where in the request its supports and forces come from.
struct PlacedLoad {
  weave::SheetLoad load;
  std::vector<json::SupportPoint> places;  ///< one for each support
  std::vector<int> force_of;               ///< index in the request of each force
};

/// The places of a request on the weave: a box becomes the places within it. Throws "weave.invalid_load" with pointers
/// where a place does not exist or a box is empty, "request.limit_exceeded" for more places than a load may have, and
/// the error of a stop request. O(crossings + strands) for each box.
PlacedLoad place_load(const json::WeaveSimulationRequest& request, const weave::Weave& weave,
                      const json::Limits& limits, const Execution& execution);

/// Pointers for the engine's faults of a load: "supports/7/clamped" becomes "/supports/2/clamped".
PointerMap load_pointers(const PlacedLoad& placed);

}  // namespace supple::routes
