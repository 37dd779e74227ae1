#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "face_distances.h"

namespace supple::voronoi {

/// The lower envelope of distances in a convex polygon of a face where it is the plainest: every place is reached
/// straight from one of several images, which are equally far from their sites. Then the borders are the bisectors of
/// images, and all of the envelope is found at once by clipping the polygon.
///
/// No path of an arrival is shorter than the straight line from its image: where the images' plane diagram says so, and
/// each image sees its cell, it is the envelope. Both are checked.
class BisectorCells {
 public:
  /// A place where paths seem to come from, and one of its arrivals.
  struct Image {
    Eigen::Vector2d place;
    std::int32_t site;
  };
  /// A corner of a cell, and what is beyond the side of it that follows: another image, or -1 - number of a side of the
  /// polygon.
  struct Corner {
    Eigen::Vector2d place;
    std::int32_t beyond;
  };
  /// The cell of an image, counterclockwise. Without a corner where it has none.
  struct Cell {
    static constexpr std::size_t most_corners = 20;
    std::array<Corner, most_corners> corners;
    std::size_t count = 0;

    const Corner& corner(std::size_t i) const { return corners[i]; }
    const Corner& before(std::size_t i) const { return corners[i > 0 ? i - 1 : count - 1]; }
    const Corner& after(std::size_t i) const { return corners[i + 1 < count ? i + 1 : 0]; }
  };

  /// Finds the cells of the arrivals `kept` in a polygon, its corners counterclockwise. False where the envelope is
  /// none of bisectors; `size` is that of the face, to which lengths are told apart by rounding. O(images^2).
  bool find(const FaceDistances& distances, const Active& kept, std::span<const Eigen::Vector2d> polygon, double size);

  std::span<const Image> images() const { return images_; }
  /// How far all images are from their sites.
  double sigma() const { return sigma_; }
  /// One for each image.
  std::span<const Cell> cells() const { return {cells_.data(), images_.size()}; }

 private:
  bool gather_images(const FaceDistances& distances, const Active& kept, double size);
  bool clip_cell(std::size_t image, std::span<const Eigen::Vector2d> polygon);
  bool sees_cell(const FaceDistances& distances, std::size_t image) const;
  /// Whether an arrival that is farther from its site is nowhere in a cell shorter than the cell's own image.
  bool is_farther(const surface::FaceArrival& arrival, std::size_t image, double size) const;

  std::vector<Image> images_;
  Active near_;  ///< the arrivals that images stand for
  std::vector<std::int32_t> near_images_;
  Active farther_;  ///< those that are farther from their sites
  std::vector<Cell> cells_;
  double sigma_ = 0;  ///< of all images
};

}  // namespace supple::voronoi
