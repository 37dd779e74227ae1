#pragma once

#include <Eigen/Core>

namespace supple::voronoi {

/// The third coordinate of the cross product of two vectors of the plane.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace supple::voronoi
