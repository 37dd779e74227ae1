#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Triangulates polygons in space without new corners.
///
/// A polygon is projected along its normal (Newell's: the sum of p x q over its sides), so it need not be quite flat.
/// If the fan from its first corner covers it once, as for every convex polygon, the fan is used. All other polygons
/// are triangulated by clipping ears [Meisters1975], and so are those whose fan has much thinner triangles than ears
/// would have. An ear is a triangle of two neighbouring sides without another corner inside or on its border, so that
/// corners on a straight side cause no triangles without area. The best-shaped ear is clipped first. Holes that are
/// joined to the outline by a bridge, which is traversed in both directions, remain holes.
///
/// The memory is reused for the next polygon. Not thread-safe.
class PolygonCutter {
 public:
  /// Maximum number of corners of a polygon that a fan does not cover. The work is quadratic, some 50 ms for this
  /// number.
  static constexpr std::size_t max_corners = 4096;

  enum class Outcome {
    cut,
    crosses_itself,    ///< its sides cross in the projection, or it encloses no area without being a line
    too_many_corners,  ///< a fan does not cover it, and it has more than `max_corners`
  };

  /// Writes triangles of indices into `corners` to `triangles`, whose size is that of `corners` less 2. They are the
  /// fan if the outcome is not `cut`, or if the corners lie on one line or are not finite. Needs at least 3 corners.
  /// O(n) for a fan, otherwise O(n^2) for n corners.
  Outcome cut(std::span<const Eigen::Vector3d> corners, std::span<Triangle> triangles);

 private:
  using Index = std::int32_t;
  /// Criteria for the triangles that count as ears, from strict to weak: also not thin; no other corner inside or on
  /// the border; no other corner inside; also triangles without area. The last two serve outlines that touch
  /// themselves.
  enum class EarCriterion { not_thin, clear_border, clear_inside, no_area };

  struct Shape {
    bool covers_once;
    double worst;  ///< quality of the worst triangle
  };

  bool project(std::span<const Eigen::Vector3d> corners);
  bool is_line(std::span<const Eigen::Vector3d> corners) const;
  Shape fan_shape() const;
  bool crosses_itself() const;
  bool clip_ears(std::span<Triangle> triangles);
  double ear_quality(Index c) const;
  bool blocks(Index q, Index p, Index c, Index n) const;
  bool points_into(Index q, Index apex, Index first, Index second) const;
  double doubled_area(Index a, Index b, Index c) const;
  double quality(Index a, Index b, Index c) const;
  bool has_area(Index a, Index b, Index c) const;
  void update_ears(std::size_t remaining, Index corner);

  double rounding_height_ = 0;           // heights that may come from rounding, relative to the polygon's extent
  double tolerance_ = 0;                 // heights up to this count as zero at present
  std::vector<Eigen::Vector2d> points_;  // the projected corners, relative to the extent
  std::vector<Index> previous_, next_;
  std::vector<double> qualities_;  // quality of the ear at each remaining corner; negative if there is none
  std::vector<Index> reflex_;      // corners that may lie in another corner's triangle
  EarCriterion criterion_ = EarCriterion::clear_border;
};

}  // namespace supple::surface
