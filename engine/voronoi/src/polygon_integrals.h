#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace supple::voronoi {

/// Corners of a convex polygon of the plane, counterclockwise.
using Polygon = std::vector<Eigen::Vector2d>;

/// Integrals over a polygon of powers of the way from a centre, which may lie anywhere.
struct PolygonIntegrals {
  double area = 0;
  double length = 0;                              ///< of |x - centre|
  Eigen::Vector2d way = Eigen::Vector2d::Zero();  ///< of x - centre
  double square = 0;                              ///< of |x - centre|^2
};

/// In closed form. O(corners).
PolygonIntegrals polygon_integrals(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& centre);

/// The integral over a polygon of |x - centre| times a unit vector that turns at another rate than x - centre does:
/// by the angle `first` where that has the direction `zero`, and by `stretch` radians more for each radian
/// counterclockwise. Seen from the centre the polygon measures no more than half a turn, none of it against `zero`. By
/// Gauss and Legendre's quadrature along the sides, to 1e-10 relative.
Eigen::Vector2d stretched_way(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& centre,
                              const Eigen::Vector2d& zero, double first, double stretch);

/// The part of a convex polygon where normal . x <= offset; empty or without area where there is none. O(corners).
void clip(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& normal, double offset, Polygon& kept);

}  // namespace supple::voronoi
