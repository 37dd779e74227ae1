#pragma once

#include <Eigen/Core>
#include <vector>

#include "print_order.h"
#include "supple/weave/toolpath.h"

namespace supple::weave {

/// The channels' nozzle positions, one polyline for each sliding crossing: from the first foot on the bottom strand
/// over the apex above the crossing to the second foot, which is farther from the crossing. The polyline runs along the
/// bottom strand in the direction in which both feet have room. z is the height over the bed; mm.
///
/// Faults are a foot beyond the end of the bottom strand, a foot next to a strand that must slide there, and a channel
/// that would touch the strand inside it. O(crossings log crossings).
std::vector<std::vector<Eigen::Vector3d>> channel_paths(const Weave& weave,
                                                        const std::vector<SlidingCrossing>& crossings,
                                                        const PrinterProfile& profile,
                                                        const std::vector<Overrun>& overruns,
                                                        const Execution& execution, PrintFaults& faults);

}  // namespace supple::weave
