#pragma once

#include <Eigen/Core>
#include <vector>

#include "print_order.h"
#include "supple/weave/toolpath.h"

namespace supple::weave {

/// A printed strand: points of its centre line, with x and y in the layout's coordinates and z the nozzle's height over
/// the bed; mm.
struct StrandPath {
  std::vector<Eigen::Vector3d> points;
  /// Says for each segment between two points whether it is lifted.
  std::vector<char> lifted;
};

/// Maximum distance of a channel's feet from its crossing along the bottom strand, mm.
double channel_reach(const Channel& channel);

/// The strands' paths, by number. Strands lie on the bed at their ends, at fused crossings, and where channels stand on
/// them. `overruns` has one entry for each strand. Too little room for a lift is a fault. Throws if a stop is
/// requested.
std::vector<StrandPath> strand_paths(const Weave& weave, const std::vector<SlidingCrossing>& crossings,
                                     const PrinterProfile& profile, const ToolpathOptions& options,
                                     const std::vector<Overrun>& overruns, const Execution& execution,
                                     PrintFaults& faults);

}  // namespace supple::weave
