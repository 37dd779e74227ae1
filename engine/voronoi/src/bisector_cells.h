#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "face_distances.h"

namespace supple::voronoi {

/// The lower envelope of distances in a convex polygon of a face in the simplest case: every place is reached straight
/// from one of several images, which are equally far from their sites. Then the borders are bisectors of images, and
/// clipping the polygon by them finds the whole envelope at once.
///
/// No path of an arrival is shorter than the straight line from its image. Therefore the images' planar Voronoi diagram
/// is the envelope if each image reaches all of its cell straight, and if no arrival of larger sigma is shorter
/// anywhere. Both are checked.
class BisectorCells {
 public:
  /// An image, from which paths come straight, and its site.
  struct Image {
    Eigen::Vector2d place;
    std::int32_t site;
  };
  /// A corner of a cell, and what lies beyond the side that follows: the index of an image, or -1 - (index of a side of
  /// the polygon).
  struct Corner {
    Eigen::Vector2d place;
    std::int32_t neighbour;
  };
  /// The cell of an image, its corners counterclockwise; empty if `count` is 0.
  struct Cell {
    static constexpr std::size_t max_corners = 20;
    std::array<Corner, max_corners> corners;
    std::size_t count = 0;

    const Corner& corner(std::size_t i) const { return corners[i]; }
    const Corner& before(std::size_t i) const { return corners[i > 0 ? i - 1 : count - 1]; }
    const Corner& after(std::size_t i) const { return corners[i + 1 < count ? i + 1 : 0]; }
  };

  /// Finds the cells of the arrivals `active` in a polygon with counterclockwise corners. Returns false if the envelope
  /// does not consist of bisectors. Tolerances are relative to `size`, the face's. O(images^2).
  bool find(const FaceDistances& distances, const Active& active, std::span<const Eigen::Vector2d> polygon,
            double size);

  std::span<const Image> images() const { return images_; }
  /// The distance of every image from its site.
  double sigma() const { return sigma_; }
  /// One cell for each image.
  std::span<const Cell> cells() const { return {cells_.data(), images_.size()}; }

 private:
  /// Fills images_ and the arrivals. Returns false if images are too many, or two sites share one.
  bool gather_images(const FaceDistances& distances, const Active& active, double size);
  /// Clips the polygon to the cell of an image. Returns false if it gets too many corners.
  bool clip_cell(std::size_t image, std::span<const Eigen::Vector2d> polygon);
  /// Whether one of the image's arrivals, or several adjacent ones together, reach all of its cell straight.
  bool reaches_cell_straight(const FaceDistances& distances, std::size_t image) const;
  /// Whether an arrival of larger sigma is nowhere in a cell shorter than the image's own paths.
  bool is_nowhere_shorter(const surface::FaceArrival& arrival, std::size_t image, double size) const;

  std::vector<Image> images_;
  Active image_arrivals_;                       ///< arrivals of the least sigma, whose images are images_
  std::vector<std::int32_t> image_of_arrival_;  ///< the image of each of image_arrivals_
  Active farther_;                              ///< all other arrivals, which have a larger sigma
  std::vector<Cell> cells_;
  double sigma_ = 0;  ///< the sigma of all images
};

}  // namespace supple::voronoi
