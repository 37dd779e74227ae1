#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace supple::surface {

/// A bundle of paths from a source into a face, straight within it: what the distances in the face are made of. In the
/// plane of the face, whose origin is corner 0 and whose axes are those of tangent_frame.
struct FaceArrival {
  /// From where paths come straight: a source in the face, one of its corners, or a source or vertex beyond a side,
  /// with the faces between unfolded.
  Eigen::Vector2d image = Eigen::Vector2d::Zero();
  /// The part of a side that they come through, with the face on the left of the way from `begin` to `end`; of paths
  /// that come from within the face (`everywhere`) nothing.
  Eigen::Vector2d begin = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  double sigma = 0;          ///< length of the way to the image
  std::int32_t source = -1;  ///< the source at which the paths begin
  bool everywhere = true;

  static constexpr double rounding = 1e-12;  ///< radians

  /// Where the path to a point of the face turns last: the image, or the end of the interval that it has to go round.
  /// Straight paths that miss the interval by rounding, as those to a point next to its end, still count as straight.
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
  /// Length of the shortest of these paths to a point of the face: never less than the point's distance.
  double length_to(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d& turn = turns_at(point);
    const double bend = &turn == &image ? 0 : (turn - image).norm();
    return sigma + bend + (point - turn).norm();
  }
};

}  // namespace supple::surface
