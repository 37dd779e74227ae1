#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/weave/gcode_check.h"

namespace supple::weave {

/// A straight move that deposited filament.
struct Bead {
  int line = 0;  ///< of the G-code
  int run = 0;   ///< beads without a travel between them have the same
  Eigen::Vector3d from{0, 0, 0};
  Eigen::Vector3d to{0, 0, 0};
  double filament = 0;  ///< deposited, mm
};

/// Runs of beads that rise at once, fall to where they began and end there, with both ends on beads of earlier runs
/// that are no higher. O(beads), and for each candidate the number of beads nearby. Throws where a stop is asked for.
std::vector<FoundChannel> find_channels(const std::vector<Bead>& beads, double strand_width,
                                        const CancellationToken& cancellation = {});

}  // namespace supple::weave
