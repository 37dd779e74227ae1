#include "face_vertex.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "planar_cross.h"
#include "planar_face.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Relative to the polygon: maximum distance of a Voronoi vertex outside it.
constexpr double vertex_outside_tolerance = 1e-9;
/// Relative to the distance: maximum difference of the distances from the vertex's sites. No other site is nearer by
/// more than four times this.
constexpr double equidistance = 2e-13;
constexpr int max_newton_steps = 30;

}  // namespace

bool find_vertex(const FaceDistances& distances, const Active& active, const std::array<Vector2d, 3>& corners,
                 const Sides& sides, const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                 double longest, Vector2d& place) {
  Vector2d x = place;
  double distance = 0;
  double error = std::numeric_limits<double>::infinity();
  const auto count = static_cast<Eigen::Index>(cuts.size());
  for (int iteration = 0; iteration < max_newton_steps; ++iteration) {
    const SiteDistance first = distances.from_site(active, boundary[cuts[0]].site, x);
    if (!std::isfinite(first.distance)) return false;
    distance = first.distance;
    double max_gap = 0;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Vector2d rhs = Vector2d::Zero();
    Eigen::Matrix2d jacobian = Eigen::Matrix2d::Zero();
    Vector2d gaps = Vector2d::Zero();
    for (Eigen::Index k = 1; k < count; ++k) {
      const SiteDistance other = distances.from_site(active, boundary[cuts[static_cast<std::size_t>(k)]].site, x);
      if (!std::isfinite(other.distance)) return false;
      const double gap = first.distance - other.distance;
      const Vector2d gap_gradient = first.gradient - other.gradient;
      max_gap = std::max(max_gap, std::abs(gap));
      if (k <= 2) {
        jacobian.row(k - 1) = gap_gradient.transpose();
        gaps[k - 1] = gap;
      }
      normal += gap_gradient * gap_gradient.transpose();
      rhs += gap_gradient * gap;
    }
    if (!(max_gap < 0.5 * error) && max_gap <= equidistance * distance) break;  // the gaps have reached rounding
    error = max_gap;
    Vector2d step;
    if (count == 3) {
      const double determinant = cross(jacobian.row(0), jacobian.row(1));
      if (determinant == 0) return false;
      step = Vector2d(jacobian(1, 1) * gaps[0] - jacobian(0, 1) * gaps[1],
                      jacobian(0, 0) * gaps[1] - jacobian(1, 0) * gaps[0]) /
             -determinant;
    } else {
      step = -normal.ldlt().solve(rhs);
    }
    const double length = step.norm();
    if (!std::isfinite(length)) return false;
    if (length > longest) step *= longest / length;
    x += step;
    if ((x - place).norm() > 2 * longest) return false;
    if (max_gap == 0) break;
  }
  if (!(error <= equidistance * distance)) return false;
  for (const Side& side : sides) {
    const Vector2d along = side.to - side.from;
    if (cross(along, x - side.from) < -vertex_outside_tolerance * along.norm() * longest) return false;
  }
  if (distances.nearest(active, x).distance < distance - 4 * equidistance * distance) return false;
  place = within_face(corners, x);
  return true;
}

}  // namespace supple::voronoi
