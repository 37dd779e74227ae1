#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "border_rounding.h"
#include "face_distances.h"

namespace supple::voronoi {

/// A point of a border.
struct BorderPoint {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double height = 0;   ///< over the chord, positive on its left
  double stretch = 1;  ///< length of the border per length of the chord at this point
  SiteDistance left{}, right{};
};

/// The place from which the shortest paths from a site come straight: the image of the site or of the vertex at which
/// the paths have turned last. `distance` is that of the site from it.
struct PseudoSource {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double distance = 0;

  double length_to(const Eigen::Vector2d& point) const { return distance + (point - place).norm(); }
};

/// Pseudo-sources of the sites on the left and on the right.
using PseudoSources = std::array<PseudoSource, 2>;

/// A point of the border with the pseudo-sources of its shortest paths. `fraction` is its position along the chord.
struct LabelledPoint {
  double fraction = 0;
  double height = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  PseudoSources sources;
};

/// Finds points of the border of two sites over a chord, and the pseudo-sources of the paths to them.
class BorderTracer {
 public:
  /// `size` is the longest side of the face; `corners` are the face's.
  BorderTracer(const FaceDistances& distances, const std::array<Eigen::Vector2d, 3>& corners, double size)
      : distances_(distances), corners_(corners), size_(size) {}

  /// Sets the chord, and forgets the pseudo-sources of the part before.
  void set_chord(const Eigen::Vector2d& begin, const Eigen::Vector2d& end);
  /// Sets the sites on both sides of the chord. Returns the number of images from which paths may come, minus one for
  /// each site.
  int set_sites(std::int32_t left, std::int32_t right, const Active& active);
  /// From now on distances are those from known pseudo-sources, which must outlive their use, or again the shortest
  /// ones if null.
  void set_sources(const PseudoSources* sources) { part_sources_ = sources; }

  /// Finds the border over a point of the chord. The search starts at the height in `point`, or at that of the guessed
  /// pseudo-sources. Returns false if the border is no function over the chord there, or higher than the chord is long.
  bool find_point(double fraction, BorderPoint& point, const PseudoSources* guess = nullptr) const;
  /// Computes the distances of the point's place from both sites.
  void measure(BorderPoint& point) const;
  /// The height in (below, above), over a place of the chord, at which the paths from both pseudo-sources are equally
  /// long. Newton's method starts at `height`, which is also the result if it fails.
  double equidistant_height(const PseudoSources& sources, const Eigen::Vector2d& base, double height, double below,
                            double above) const;
  /// Heights between which the normal through a place of the chord lies in the face, with a small margin.
  std::pair<double, double> heights_within_face(const Eigen::Vector2d& base) const;

  /// The pseudo-sources of the only images, if these reach both ends of the chord straight, and so all of it.
  std::optional<PseudoSources> straight_sources() const;
  PseudoSources pseudo_sources_at(const BorderPoint& point) const;
  LabelledPoint labelled(double fraction, const BorderPoint& point) const {
    return {fraction, point.height, point.place, pseudo_sources_at(point)};
  }
  bool same(const PseudoSource& one, const PseudoSource& other) const {
    const double tolerance = same_image * size_;
    return (one.place - other.place).squaredNorm() <= tolerance * tolerance &&
           std::abs(one.distance - other.distance) <= tolerance;
  }
  bool same(const PseudoSources& one, const PseudoSources& other) const {
    return same(one[0], other[0]) && same(one[1], other[1]);
  }
  /// Whether the shortest paths from both sites come from the point's pseudo-sources, up to `tolerance`: others are not
  /// shorter, and these exist.
  bool is_on_border(const LabelledPoint& point, double tolerance) const;

  const std::array<Eigen::Vector2d, 3>& corners() const { return corners_; }
  double size() const { return size_; }
  const Eigen::Vector2d& begin() const { return begin_; }
  Eigen::Vector2d end() const { return begin_ + chord_; }
  const Eigen::Vector2d& chord() const { return chord_; }
  const Eigen::Vector2d& normal() const { return normal_; }  ///< unit normal of the chord, to its left
  double length() const { return length_; }                  ///< length of the chord
  const PseudoSources* sources() const { return part_sources_; }
  /// Arrivals that may be the shortest along the border, from the site on one side (0: left).
  const Active& arrivals_on(std::size_t side) const { return side == 0 ? from_left_ : from_right_; }
  const surface::FaceArrival& arrival(std::int32_t i) const {
    return distances_.arrivals()[static_cast<std::size_t>(i)];
  }

 private:
  const surface::FaceArrival* straight_arrival(const Active& active) const;
  PseudoSource pseudo_source_of(const SiteDistance& shortest, const Eigen::Vector2d& place) const;

  const FaceDistances& distances_;
  std::array<Eigen::Vector2d, 3> corners_;
  double size_;
  Eigen::Vector2d begin_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d chord_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal_ = Eigen::Vector2d::Zero();
  double length_ = 0;
  std::int32_t left_ = -1;
  std::int32_t right_ = -1;
  Active from_left_, from_right_;
  const PseudoSources* part_sources_ = nullptr;  ///< those of the current part; null if not known
};

}  // namespace supple::voronoi
