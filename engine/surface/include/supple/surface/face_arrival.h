#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace supple::surface {

/// A bundle of paths from a source into a face, which are straight within the face. The distance of a point of the face
/// is the least length over such bundles. Coordinates are in the plane of the face, whose origin is corner 0 and whose
/// axes are those of tangent_frame.
struct FaceArrival {
  /// The position from which the paths come straight: a source in the face, one of its corners, or a source or vertex
  /// beyond a side, with the faces between unfolded.
  Eigen::Vector2d image = Eigen::Vector2d::Zero();
  /// The interval of a side through which the paths come. The face lies to the left of the direction from `begin` to
  /// `end`. It is unused if the paths come from within the face (`everywhere`).
  Eigen::Vector2d begin = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  double sigma = 0;          ///< length of the path from the source to the image
  std::int32_t source = -1;  ///< the source at which the paths begin
  bool everywhere = true;

  static constexpr double rounding = 1e-12;  ///< tolerance of directions in radians

  /// The position at which the path to a point of the face turns last: the image, or the end of the interval around
  /// which it has to turn. A path that misses the interval by rounding only, such as one to a point next to the
  /// interval's end, counts as straight.
  const Eigen::Vector2d& turns_at(const Eigen::Vector2d& point) const {
    if (everywhere) return image;
    const Eigen::Vector2d to = point - image;
    const auto misses = [&](const Eigen::Vector2d& edge, double side) {
      const double across = side * (edge.x() * to.y() - edge.y() * to.x());
      return across > 0 && across * across > rounding * rounding * edge.squaredNorm() * to.squaredNorm();
    };
    if (misses(begin - image, 1)) return begin;
    return misses(end - image, -1) ? end : image;
  }
  /// The length of the shortest of these paths to a point of the face. It is never less than the point's distance.
  double length_to(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d& turn = turns_at(point);
    const double bend = &turn == &image ? 0 : (turn - image).norm();
    return sigma + bend + (point - turn).norm();
  }
};

}  // namespace supple::surface
