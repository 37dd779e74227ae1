#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "supple/dataset/dataset.h"
#include "supple/microscale/simulation.h"

namespace supple::lab {

// Which loads a design is put under.
//
// A network learns the energy of a family from the states that a budget of simulations allows. Designs teach more than
// strains of one design, so that each design gets few load paths, and all designs together cover directions and
// magnitudes evenly:
//
// - Paths start at rest and every path ends at the limit of its range. A state far from rest costs the load steps up to
//   it in any case; on a path they are shared, and the branch is the one that a slow test would follow.
// - Uniaxial tension and compression have paths of their own, since uniaxial states are a surface in the space of
//   strains that biaxial ones do not come near.
// - Directions are continuous in [0, pi), not a grid: every design sees others. The paths of a kind are evenly turned
//   against each other within the design, and the turn as a whole comes from the design's low-discrepancy point.
// - Biaxial paths are rays from (s, s0) = (1, 1) to a point on the border of the square [lowest, highest]^2 of
//   stretches, evenly spread along the border.
// - States become denser towards rest, with the square of their number: errors count relative to stress, which the
//   initial stiffness rules. A random offset for each path keeps states of different designs apart.

enum class PlanKind {
  sequence,  ///< a few paths for each design, as above
  /// Every direction k pi/15 with uniaxial stretches 1.001 + 0.016 k up to 1.5 and 0.999 - 0.016 k down to 0.7, and
  /// biaxial ones in steps of 0.03 from 0.9 to 1.17, each from rest: the grid of published data sets.
  grid,
  /// The state of rest alone, for its tangent: one linear solve.
  rest
};

struct LoadPlanOptions {
  PlanKind kind = PlanKind::sequence;
  int tension_paths = 2;
  int compression_paths = 2;
  int biaxial_paths = 3;
  int tension_states = 6;  ///< states of one path, likewise below
  int compression_states = 6;
  int biaxial_states = 5;
  double largest_stretch = 1.5;           ///< end of uniaxial tension
  double smallest_stretch = 0.7;          ///< end of uniaxial compression
  double largest_biaxial_stretch = 1.2;   ///< upper limit of both stretches
  double smallest_biaxial_stretch = 0.9;  ///< lower limit of both stretches
  double first_strain = 1e-3;             ///< no state is nearer to rest than this change of stretch
};

/// Throws "dataset.invalid_option", which names each option with its limits.
void check(const LoadPlanOptions& options);

struct PlannedPath {
  dataset::Path path;                            ///< kind, direction, end and number of states
  std::vector<std::array<double, 2>> stretches;  ///< (s, s0) of each state; s0 is 0 where it is free
  microscale::Load load() const;
};

/// Plans the paths of a design. `turns` are its low-discrepancy coordinates in (0, 1). They determine the directions of
/// tension, compression and biaxial paths, and the place on the border of the biaxial square. `seed` determines the
/// offsets. Equal input gives equal paths. `options` must have passed `check`.
std::vector<PlannedPath> plan_loads(const LoadPlanOptions& options, const std::array<double, 4>& turns,
                                    std::uint64_t seed);

}  // namespace supple::lab
