#include "face_vertex.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "planar_cross.h"
#include "planar_face.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Relative to the polygon: a Voronoi vertex may be this far outside.
constexpr double vertex_outside = 1e-9;
/// Relative to the distance: distances to the sites of a vertex differ by no more, and no other site is nearer by more.
constexpr double equidistance = 2e-13;
constexpr int most_newton_steps = 30;

}  // namespace

bool find_vertex(const FaceDistances& distances, const Active& active, const std::array<Vector2d, 3>& corners,
                 const Sides& sides, const std::vector<BoundaryVertex>& boundary, const std::vector<std::size_t>& cuts,
                 double longest, Vector2d& place) {
  Vector2d x = place;
  double distance = 0;
  double error = std::numeric_limits<double>::infinity();
  const auto count = static_cast<Eigen::Index>(cuts.size());
  for (int step = 0; step < most_newton_steps; ++step) {
    const Slope first = distances.from_site(active, boundary[cuts[0]].site, x);
    if (!std::isfinite(first.distance)) return false;
    distance = first.distance;
    double worst = 0;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Vector2d right = Vector2d::Zero();
    Eigen::Matrix2d two = Eigen::Matrix2d::Zero();
    Vector2d gaps = Vector2d::Zero();
    for (Eigen::Index k = 1; k < count; ++k) {
      const Slope other = distances.from_site(active, boundary[cuts[static_cast<std::size_t>(k)]].site, x);
      if (!std::isfinite(other.distance)) return false;
      const double gap = first.distance - other.distance;
      const Vector2d slope = first.gradient - other.gradient;
      worst = std::max(worst, std::abs(gap));
      if (k <= 2) {
        two.row(k - 1) = slope.transpose();
        gaps[k - 1] = gap;
      }
      normal += slope * slope.transpose();
      right += slope * gap;
    }
    if (!(worst < 0.5 * error) && worst <= equidistance * distance) break;  // as small as rounding lets it be
    error = worst;
    Vector2d way;
    if (count == 3) {
      const double determinant = cross(two.row(0), two.row(1));
      if (determinant == 0) return false;
      way =
          Vector2d(two(1, 1) * gaps[0] - two(0, 1) * gaps[1], two(0, 0) * gaps[1] - two(1, 0) * gaps[0]) / -determinant;
    } else {
      way = -normal.ldlt().solve(right);
    }
    const double length = way.norm();
    if (!std::isfinite(length)) return false;
    if (length > longest) way *= longest / length;
    x += way;
    if ((x - place).norm() > 2 * longest) return false;
    if (worst == 0) break;
  }
  if (!(error <= equidistance * distance)) return false;
  for (const Side& side : sides) {
    const Vector2d along = side.to - side.from;
    if (cross(along, x - side.from) < -vertex_outside * along.norm() * longest) return false;
  }
  if (distances.nearest(active, x).distance < distance - 4 * equidistance * distance) return false;
  place = within_face(corners, x);
  return true;
}

}  // namespace supple::voronoi
