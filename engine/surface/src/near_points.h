#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"

namespace supple::surface {

/// For each point the first point, by index, that is no further than `distance` and is itself the first of its own: a
/// point is the first of its own unless an earlier one of that kind is near. All coordinates are finite. O(n log n) for
/// any points: those that are the first of their own are more than `distance` apart.
std::vector<std::int32_t> first_near_points(const std::vector<Eigen::Vector3d>& points, double distance,
                                            const Execution& execution = {});

/// The same with a distance for each point: two are near each other if they are no further apart than the lesser of
/// theirs.
std::vector<std::int32_t> first_near_points(const std::vector<Eigen::Vector3d>& points,
                                            const std::vector<double>& distances, const Execution& execution = {});

}  // namespace supple::surface
