#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/weave/gcode_check.h"

namespace supple::weave {

/// A straight move that deposited filament.
struct Bead {
  int line = 0;  ///< line of the G-code, counted from 1
  int run = 0;   ///< number of the run: beads without a travel between them have the same
  Eigen::Vector3d from{0, 0, 0};
  Eigen::Vector3d to{0, 0, 0};
  double filament = 0;  ///< deposited filament, mm
};

/// Finds channels: runs of beads that first only rise and then only fall to the height at which they began. Both ends
/// are on beads of earlier runs that are no higher. O(beads), and for each candidate the number of beads nearby. Throws
/// if a stop is requested.
std::vector<FoundChannel> find_channels(const std::vector<Bead>& beads, double strand_width,
                                        const CancellationToken& cancellation = {});

}  // namespace supple::weave
