#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"

namespace supple::surface {

/// For each point, the smallest index of a point with exactly the same coordinates. 0 equals -0. A point with a
/// coordinate that is not finite equals only itself. O(n log n) for any points.
std::vector<std::int32_t> first_equal_points(const std::vector<Eigen::Vector3d>& points,
                                             const Execution& execution = {});

}  // namespace supple::surface
