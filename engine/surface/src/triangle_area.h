#pragma once

#include <Eigen/Geometry>

namespace supple::surface {

/// The normal of the triangle a b c, whose length is twice the area. It is computed from the two shorter sides: if one
/// side is much shorter than the others, their product suffers from cancellation.
inline Eigen::Vector3d doubled_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, bc = c - b, ca = a - c;
  const double squared[3] = {ab.squaredNorm(), bc.squaredNorm(), ca.squaredNorm()};
  if (squared[0] >= squared[1] && squared[0] >= squared[2]) return bc.cross(ca);
  return squared[1] >= squared[2] ? ca.cross(ab) : ab.cross(bc);
}

}  // namespace supple::surface
