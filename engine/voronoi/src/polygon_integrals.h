#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace supple::voronoi {

/// Corners of a convex polygon in the plane, counterclockwise.
using Polygon = std::vector<Eigen::Vector2d>;

/// Integrals over a polygon of functions of x - centre. The centre may lie anywhere.
struct PolygonIntegrals {
  double area = 0;
  double length = 0;                                 ///< integral of |x - centre|
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  ///< integral of x - centre
  double square = 0;                                 ///< integral of |x - centre|^2
};

/// Computes the integrals in closed form. O(corners).
PolygonIntegrals polygon_integrals(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& centre);

/// The integral over a polygon of |x - centre| times a unit vector whose angle is `first` where x - centre has the
/// direction `zero`, and grows by `stretch` radians for each radian that x - centre turns counterclockwise. Seen from
/// the centre, the polygon must span at most half a turn and not contain the direction opposite to `zero`.
/// Gauss-Legendre quadrature along the sides, to 1e-10 relative.
Eigen::Vector2d stretched_offset(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& centre,
                                 const Eigen::Vector2d& zero, double first, double stretch);

/// Sets `clipped` to the part of a convex polygon where normal . x <= offset. It is empty or has no area if there is no
/// such part. O(corners).
void clip(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& normal, double offset, Polygon& clipped);

}  // namespace supple::voronoi
