#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Cuts polygons in space into triangles between their corners, without new ones.
///
/// A polygon is seen along its normal (Newell's: the sum of p x q over its sides), so it need not be quite flat. Where
/// the fan from its first corner covers it once, as it does every convex polygon, the fan is taken. All other polygons,
/// and those whose fan has triangles thinner than another cut needs, lose one ear after the other (Meisters 1975,
/// "Polygons have ears"), each time the one of the best shape: a triangle of two neighbouring sides without another
/// corner in it or on its border, so that corners on a straight side cost no triangle without area. Holes that a
/// bridge, walked forth and back, joins to the outline stay holes.
///
/// Keeps its memory from one polygon to the next; one thread at a time.
class PolygonCutter {
 public:
  /// Most corners of a polygon that a fan does not cut: the work is quadratic in them, here some 50 ms.
  static constexpr std::size_t most_corners = 4096;

  enum class Outcome {
    cut,
    crosses_itself,    ///< its sides cross as seen along the normal, or it encloses no area without being a line
    too_many_corners,  ///< a fan does not cover it and it has more than `most_corners`
  };

  /// `triangles`, of two entries less than `corners`, receives the corners' places in `corners`; it is the fan where
  /// the outcome is not `cut`, or where the corners lie on one line or are not finite. At least 3 corners. O(n) for a
  /// fan, else O(n^2) with n the number of corners.
  Outcome cut(std::span<const Eigen::Vector3d> corners, std::span<Triangle> triangles);

 private:
  using Index = std::int32_t;
  /// Which triangles count as ears: the best ones first, the last two are for outlines that touch themselves.
  enum class Allowed { not_thin, clear_border, clear_inside, no_area };

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
  bool leads_into(Index q, Index apex, Index first, Index second) const;
  double doubled_area(Index a, Index b, Index c) const;
  double quality(Index a, Index b, Index c) const;
  bool has_area(Index a, Index b, Index c) const;
  void refresh(std::size_t left, Index some);

  double flat_ = 0;                      // heights that rounding may make, in units of the polygon's extent
  double tolerance_ = 0;                 // heights that count as none at present
  std::vector<Eigen::Vector2d> points_;  // as seen along the normal, scaled to the extent
  std::vector<Index> previous_, next_;
  std::vector<double> qualities_;  // of the ear at each corner that is left; negative for none
  std::vector<Index> reflex_;      // corners that may lie in another's triangle
  Allowed allowed_ = Allowed::clear_border;
};

}  // namespace supple::surface
