#pragma once

#include "supple/base/cancellation.h"
#include "supple/design/inverse_design.h"

namespace supple::design {

/// Like `find_design`, but a stop by the deadline or a limit of memory is not taken back: searches of other spaces,
/// which run beside this one, share the token.
Design search_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                     const Execution& execution, const OnProgress& progress);

/// The reason of the stop that ended a search; `none` if it ended by itself.
StopReason reason_of(DesignTermination stopped);
/// How a search ended that was stopped for this reason.
DesignTermination termination_by(StopReason reason);

}  // namespace supple::design
