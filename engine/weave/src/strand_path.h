#pragma once

#include <Eigen/Core>
#include <vector>

#include "print_order.h"
#include "supple/weave/toolpath.h"

namespace supple::weave {

/// A printed strand: points of its centre line in the layout's coordinates, z the nozzle's height over the bed; mm.
struct StrandPath {
  std::vector<Eigen::Vector3d> points;
  /// For each segment between two points whether it is lifted.
  std::vector<char> lifted;
};

/// How far a channel's feet may be from its crossing, along the bottom strand; mm.
double channel_reach(const Channel& channel);

/// The strands' paths, by number. Strands are flat at their ends, at fused crossings, and where channels stand on them.
/// `overruns` has one entry for each strand. Too little room for a lift is a fault. Stops where a stop is requested.
std::vector<StrandPath> strand_paths(const Weave& weave, const std::vector<SlidingCrossing>& crossings,
                                     const PrinterProfile& profile, const ToolpathOptions& options,
                                     const std::vector<Overrun>& overruns, const Execution& execution,
                                     PrintFaults& faults);

}  // namespace supple::weave
