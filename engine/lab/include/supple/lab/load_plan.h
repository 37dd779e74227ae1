#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "supple/dataset/dataset.h"
#include "supple/microscale/simulation.h"

namespace supple::lab {

// The loads of a design in a data set.
//
// The number of simulated states is limited by their cost. A network learns more from a new design than from more
// strains of the same design. Therefore each design has few load paths, and all designs together cover directions and
// magnitudes evenly:
//
// - A path starts at rest (zero strain) and ends at the limit of its range. A state far from rest needs load steps up
// to
//   it in any case. The states of a path share these steps, and are on the branch that a slow test would follow.
// - Uniaxial tension and compression have paths of their own, because uniaxial states are a surface in the space of
//   strains that biaxial states do not come near.
// - Directions are any number in [0, pi), so that each design has other ones. The directions of a design's paths of one
//   kind are evenly spaced, and an offset for all of them is a coordinate of the design's low-discrepancy point.
// - Biaxial paths are rays from (s, s0) = (1, 1) to a point on the boundary of the square of stretches
//   [min_biaxial_stretch, max_biaxial_stretch]^2. These points are evenly spread along the boundary.
// - Strains grow with the square of the number of the state, so that states are denser towards rest. The reason is that
//   errors are relative to the stress, which at small strains depends on the initial stiffness. A random offset for
//   each path makes the strains of different designs differ.

enum class PlanKind {
  sequence,  ///< a few paths for each design, as above
  /// The grid of published data sets [LiCoros2023]. It has each direction k pi/15, with uniaxial stretches 1.001 +
  /// 0.016 k up to 1.5 and 0.999 - 0.016 k down to 0.7, and biaxial stretches from 0.9 to 1.17 in steps of 0.03, each
  /// of which is a path of its own.
  grid,
  /// The undeformed state alone, for its tangent. It costs one linear solve.
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
  double max_stretch = 1.5;          ///< end of uniaxial tension
  double min_stretch = 0.7;          ///< end of uniaxial compression
  double max_biaxial_stretch = 1.2;  ///< upper limit of both stretches
  double min_biaxial_stretch = 0.9;  ///< lower limit of both stretches
  double first_strain = 1e-3;        ///< least change of stretch of a state
};

/// Throws "dataset.invalid_option", which names each option with its limits.
void check(const LoadPlanOptions& options);

struct PlannedPath {
  dataset::Path path;                            ///< kind, direction, end and number of states
  std::vector<std::array<double, 2>> stretches;  ///< (s, s0) of each state; s0 is 0 where it is free
  microscale::Load load() const;
};

/// Plans the paths of a design. `load_coordinates` are low-discrepancy coordinates in (0, 1). The first three determine
/// the directions of tension, compression and biaxial paths, and the last one the points on the boundary of the biaxial
/// square. `seed` determines the random offsets. Equal input gives equal paths. `options` must have passed `check`.
std::vector<PlannedPath> plan_loads(const LoadPlanOptions& options, const std::array<double, 4>& load_coordinates,
                                    std::uint64_t seed);

}  // namespace supple::lab
