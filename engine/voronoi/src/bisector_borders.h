#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "bisector_cells.h"
#include "face_cutter.h"
#include "polygon_sides.h"

namespace supple::voronoi {

/// The borders in a convex polygon of a face if all of them are bisectors of images (FaceDistances), which are the
/// unfolded positions of sites or of the last vertices before the face. They end at the given cuts of the polygon's
/// sides. A cut is a point of a side at which the nearest site changes.
class BisectorBorders {
 public:
  /// Finds the borders. `boundary` has the polygon's corners and cuts in order, and `cuts` the indices of the cuts in
  /// it. New points are numbered from `first_point` on. Tolerances are relative to `size`, that of the face in mesh
  /// units. Returns false if not all borders are bisectors, or if cells and cuts are inconsistent by rounding.
  bool find(const FaceDistances& distances, const Active& active, std::span<const Eigen::Vector2d> polygon,
            std::span<const BoundaryVertex> boundary, std::span<const std::size_t> cuts, std::int32_t first_point,
            double size);

  /// Points at which three images meet: Voronoi vertices, or bends of borders if two of the images belong to one site.
  const std::vector<FacePoint>& points() const { return points_; }
  /// Straight parts of borders between points and cuts. Their lengths are not set.
  const std::vector<FaceBorder>& borders() const { return borders_; }

  std::size_t pieces() const { return cells_.images().size(); }
  std::int32_t site_of_piece(std::size_t image) const { return cells_.images()[image].site; }
  /// Appends the corners of an image's piece, which is its cell; none if the cell is empty. A corner at which borders
  /// end is place(end), with the number of the end, so that all pieces have exactly the same corner there.
  template <typename Place>
  void write_piece(std::size_t image, const Place& place, std::vector<Eigen::Vector2d>& corners) const {
    const BisectorCells::Cell& cell = cells_.cells()[image];
    corners.reserve(cell.count);
    for (std::size_t k = 0; k < cell.count; ++k) {
      const std::int32_t end = find_end(end_key(image, cell.before(k).neighbour, cell.corner(k).neighbour));
      corners.push_back(end == no_end ? cell.corner(k).place : place(end));
    }
  }

 private:
  /// Key of a point at which borders end: the three images that meet there, or two images and a side of the polygon,
  /// ascending. Images and sides are numbered as in BisectorCells::Corner.
  using EndKey = std::array<std::int32_t, 3>;
  /// A point of a polygon's side at which images of two sites meet.
  struct Crossing {
    std::int32_t side;
    std::int32_t one, other;  ///< indices of images
    std::int32_t cut;
  };
  /// A border as one cell has it. It is matched once the cell on its other side has the same one.
  struct HalfBorder {
    std::int32_t left, right;  ///< indices of images
    EndKey from, to;
    Eigen::Vector2d begin, end;
    bool matched;
  };
  static constexpr std::int32_t no_end = std::numeric_limits<std::int32_t>::min();

  static EndKey end_key(std::size_t image, std::int32_t before, std::int32_t after);
  /// Finds the cells' crossings of the sides. Returns false if they do not agree with the cuts.
  bool find_crossings(std::span<const Eigen::Vector2d> polygon, std::span<const BoundaryVertex> boundary,
                      std::span<const std::size_t> cuts, double size);
  /// Adds the point or cut at which borders end, if ends_ lacks it. Returns false if its position is not accurate to
  /// rounding.
  bool add_end(const EndKey& key, const Eigen::Vector2d& guess, double size);
  std::int32_t find_end(const EndKey& key) const;

  BisectorCells cells_;
  std::int32_t first_point_ = 0;
  std::vector<Crossing> crossings_;
  std::vector<HalfBorder> half_borders_;
  std::vector<std::pair<EndKey, std::int32_t>> ends_;  ///< ends of borders, numbered as in FaceBorder
  std::vector<FacePoint> points_;
  std::vector<FaceBorder> borders_;
};

}  // namespace supple::voronoi
