#pragma once

#include <Eigen/Core>
#include <vector>

#include "print_order.h"
#include "supple/weave/toolpath.h"

namespace supple::weave {

/// The channels' nozzle positions, one polyline for each sliding crossing: from the first foot on the bottom strand
/// over the apex above the crossing to the second foot, farther away; either way along the strand, whichever has room.
/// z is the height over the bed; mm. Faults: a foot that the bottom strand does not reach, or beside a strand that must
/// slide there; a channel that would touch the strand within. O(crossings log crossings).
std::vector<std::vector<Eigen::Vector3d>> channel_paths(const Weave& weave,
                                                        const std::vector<SlidingCrossing>& crossings,
                                                        const PrinterProfile& profile,
                                                        const std::vector<Overrun>& overruns,
                                                        const Execution& execution, PrintFaults& faults);

}  // namespace supple::weave
