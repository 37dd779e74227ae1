#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "border_curve.h"
#include "face_distances.h"

namespace supple::voronoi {

/// A quadrature point on a border.
struct FaceSample {
  std::int32_t left = -1;
  std::int32_t right = -1;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double weight = 0;  ///< length of the border that it stands for, mesh units
  /// Quadrature point and weight of the area between the border and its chord. The area is positive where it belongs to
  /// the right cell, and negative where it belongs to the left one.
  Eigen::Vector2d area_place = Eigen::Vector2d::Zero();
  double area = 0;
};

/// A border between two points of a face as a polyline. Its points are the bends, and those on arcs that the required
/// accuracy needs.
struct BorderPolyline {
  struct Point {
    Eigen::Vector2d place;
    double distance;  ///< from each of the two sites
    bool on_arc;      ///< whether the point is for drawing only: the border does not bend here
  };
  std::vector<Point> points;    ///< between the ends
  std::vector<double> lengths;  ///< along the border, between successive points and ends: one more than points
  /// Area between the border and the polyline: positive where it belongs to the right cell, negative where it belongs
  /// to the left one.
  double area = 0;
  std::vector<FaceSample> samples;  ///< empty unless requested
  bool failed = false;              ///< whether a part of the border could not be traced and is taken as straight

  /// Replaces the border by the straight line between its ends.
  void set_straight(std::int32_t left, std::int32_t right, const Eigen::Vector2d& begin, const Eigen::Vector2d& end,
                    bool with_samples);
};

/// Traces the border between two places of a face, with these sites on its left and right. Overwrites `line` and reuses
/// its memory. With `samples` all bends are found, otherwise those that matter for areas or drawing.
void trace_border(BorderCurve& curve, const Eigen::Vector2d& begin, const Eigen::Vector2d& end, std::int32_t left,
                  std::int32_t right, const Active& active, bool samples, BorderPolyline& line);

}  // namespace supple::voronoi
