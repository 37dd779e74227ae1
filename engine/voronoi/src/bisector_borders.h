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

/// The borders in a convex polygon of a face where all of them are bisectors of images (BisectorCells), joined to the
/// cuts of the polygon's sides, which have been found by themselves.
class BisectorBorders {
 public:
  /// `boundary` has the polygon's corners and the cuts of its sides in their order; `cuts` are the indices of the cuts
  /// in it. Points get numbers from `first_point` on. False where the envelope does not consist of bisectors, or where
  /// cells and cuts do not fit together because places are the same but for rounding.
  bool find(const FaceDistances& distances, const Active& kept, std::span<const Eigen::Vector2d> polygon,
            std::span<const BoundaryVertex> boundary, std::span<const std::size_t> cuts, std::int32_t first_point,
            double size);

  /// Where three images meet: Voronoi vertices, and bends of borders where two of these are one site's.
  const std::vector<FacePoint>& points() const { return points_; }
  /// Straight parts of borders between points, or cuts, without their lengths.
  const std::vector<FaceBorder>& borders() const { return borders_; }

  std::size_t pieces() const { return cells_.images().size(); }
  std::int32_t site_of_piece(std::size_t image) const { return cells_.images()[image].site; }
  /// The corners of an image's piece, none where it has no piece. Where borders end, they are place(end), so that all
  /// pieces have the same corner there.
  template <typename Place>
  void write_piece(std::size_t image, const Place& place, std::vector<Eigen::Vector2d>& corners) const {
    const BisectorCells::Cell& cell = cells_.cells()[image];
    corners.reserve(cell.count);
    for (std::size_t k = 0; k < cell.count; ++k) {
      const std::int32_t end = known_end(meeting(image, cell.before(k).beyond, cell.corner(k).beyond));
      corners.push_back(end == no_end ? cell.corner(k).place : place(end));
    }
  }

 private:
  /// Where a border of two images ends: these and the third one, or side, that it meets there, ascending.
  using Meeting = std::array<std::int32_t, 3>;
  /// Where two images of different sites meet on a side of the polygon.
  struct Crossing {
    std::int32_t side;
    std::int32_t one, other;  ///< images
    std::int32_t cut;
  };
  /// A border that one cell has found, and whether (`twice`) the cell on its other side has found the same.
  struct HalfBorder {
    std::int32_t left, right;  ///< images
    Meeting from, to;
    Eigen::Vector2d begin, end;
    bool twice;
  };
  static constexpr std::int32_t no_end = std::numeric_limits<std::int32_t>::min();

  static Meeting meeting(std::size_t image, std::int32_t before, std::int32_t after);
  bool find_crossings(std::span<const Eigen::Vector2d> polygon, std::span<const BoundaryVertex> boundary,
                      std::span<const std::size_t> cuts, double size);
  /// Adds the point or names the cut at which borders end; false where it is not sure.
  bool add_end(const Meeting& meeting, const Eigen::Vector2d& about, double size);
  std::int32_t known_end(const Meeting& meeting) const;

  BisectorCells cells_;
  std::int32_t first_point_ = 0;
  std::vector<Crossing> crossings_;
  std::vector<HalfBorder> half_borders_;
  std::vector<std::pair<Meeting, std::int32_t>> ends_;  ///< as in FaceBorder
  std::vector<FacePoint> points_;
  std::vector<FaceBorder> borders_;
};

}  // namespace supple::voronoi
