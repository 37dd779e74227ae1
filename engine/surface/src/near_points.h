#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"

namespace supple::surface {

/// Chooses representatives, and returns for each point the index of its representative. Points are visited in their
/// order. A point within `distance` of an earlier representative gets the first such representative. Any other point
/// becomes a representative, its own one. All coordinates must be finite. O(n log n) for any points, because
/// representatives are more than `distance` apart.
std::vector<std::int32_t> first_near_points(const std::vector<Eigen::Vector3d>& points, double distance,
                                            const Execution& execution = {});

/// The same with a distance for each point. Two points are near each other if they are no further apart than the
/// smaller of their distances.
std::vector<std::int32_t> first_near_points(const std::vector<Eigen::Vector3d>& points,
                                            const std::vector<double>& distances, const Execution& execution = {});

}  // namespace supple::surface
