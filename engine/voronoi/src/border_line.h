#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "border_curve.h"
#include "face_distances.h"

namespace supple::voronoi {

/// A point of quadrature on a border.
struct FaceSample {
  std::int32_t left = -1;
  std::int32_t right = -1;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double weight = 0;
  /// A point of quadrature of the area between the border and the straight line between its bends or ends, and its
  /// weight: area that is the right cell's and not the left one's, or the other way round where it is negative.
  Eigen::Vector2d beside = Eigen::Vector2d::Zero();
  double area = 0;
};

/// A border between two points of a face as a polyline: with its bends, and with points on its arcs, so that the
/// polyline is as near to it as the accuracy of its curve asks for.
struct BorderLine {
  struct Point {
    Eigen::Vector2d place;
    double distance;  ///< from the sites on both sides
    bool on_arc;      ///< for drawing only: the border does not bend here
  };
  std::vector<Point> points;  ///< between the ends
  std::vector<double>
      lengths;  ///< along the border, between neighbours of the points and the ends: one more than points
  /// Area between the border and the polyline: what the right cell has and the left one does not, or the other way
  /// round where it is negative.
  double beside = 0;
  std::vector<FaceSample> samples;  ///< if asked for
  bool lost = false;                ///< whether some part of the border was not found and is taken as straight

  /// Makes it the straight line between its ends.
  void take_straight(std::int32_t left, std::int32_t right, const Eigen::Vector2d& begin, const Eigen::Vector2d& end,
                     bool with_samples);
};

/// Follows the border between two places of a face, which has these sites on its left and right, into `line`, of which
/// the room is used again. With `samples` all bends are found, otherwise those that areas or the drawing show.
void trace_border(BorderCurve& curve, const Eigen::Vector2d& begin, const Eigen::Vector2d& end, std::int32_t left,
                  std::int32_t right, const Active& active, bool samples, BorderLine& line);

}  // namespace supple::voronoi
