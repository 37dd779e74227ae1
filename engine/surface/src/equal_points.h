#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"

namespace supple::surface {

/// For each point the smallest index of a point with the same coordinates, compared exactly, 0 and -0 being equal. A
/// point with a coordinate that is not finite equals only itself. O(n log n) whatever the points are.
std::vector<std::int32_t> first_equal_points(const std::vector<Eigen::Vector3d>& points,
                                             const Execution& execution = {});

}  // namespace supple::surface
