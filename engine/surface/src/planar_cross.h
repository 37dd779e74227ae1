#pragma once

#include <Eigen/Core>

namespace supple::surface {

/// Twice the signed area of the triangle (0, a, b): positive where b is to the left of a.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace supple::surface
