#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "face_distances.h"
#include "polygon_integrals.h"

namespace supple::voronoi {

/// A convex part of a face to which the straight paths of one arrival are the shortest.
struct StraightRegion {
  std::int32_t arrival = -1;
  std::span<const Eigen::Vector2d> corners;
};

/// A quadrature point of the area between a curved border and its chord, along which two regions are divided. The area
/// is moved from one region to the other.
struct Sliver {
  std::int32_t loses = -1;  ///< arrival whose polygon contains the area
  std::int32_t gains = -1;  ///< arrival to which the area belongs
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double area = 0;  ///< quadrature weight, negative if the area is to be moved in the other direction
};

/// Divides convex polygons of a face into the regions of one site's arrivals. Where the shortest paths come from one
/// image of the site, the squared distance from it is a polynomial or nearly so.
///
/// Two images that are equally far from the site are equally near along a straight line, and bundles of paths end at
/// straight lines: most regions are exact. Otherwise the border of two regions is an arc of a hyperbola. It is divided
/// into short chords, and slivers at quadrature points of each chord correct for the area between arc and chord.
///
/// Regions are visited as they are found and are not stored, because there can be a hundred thousand where many
/// arrivals compete. Memory: the polygons that are being divided, and the slivers.
class StraightRegions {
 public:
  using Visit = std::function<void(const StraightRegion&)>;

  /// `size` is the size of the face, to which tolerances are relative. `visit` is called for each region.
  StraightRegions(const FaceDistances& distances, double size, Visit visit)
      : distances_(distances), size_(size), visit_(std::move(visit)) {}

  /// Visits the regions of `active`, arrivals of one site, within a polygon, and appends their slivers. O(arrivals^2)
  /// for each region.
  void divide(std::span<const Eigen::Vector2d> polygon, const Active& active);
  void clear() { slivers_.clear(); }

  const std::vector<Sliver>& slivers() const { return slivers_; }

 private:
  void divide(const Polygon& polygon, const Active& active, int depth);
  /// Divides the polygon along a line at which a bundle of paths ends, and both halves further. Returns false if no
  /// such line crosses it.
  bool divide_by_bundles(const Polygon& polygon, const Active& active, int depth);
  void divide_by_line(const Polygon& polygon, const Eigen::Vector2d& normal, double offset, const Active& active,
                      int depth);
  void halve(const Polygon& polygon, const Active& active, int depth);
  /// Drops arrivals that are nowhere shorter than another one of `active` that reaches the whole polygon straight.
  void drop_longer(const Polygon& polygon, Active& active) const;
  void divide_by_bisectors(const Polygon& polygon, const Active& active);
  /// Visits the regions of two arrivals. Returns false, and visits none, if their border is too strongly curved.
  bool divide_by_hyperbola(const Polygon& polygon, std::int32_t one, std::int32_t other);
  void add(const Polygon& polygon, std::int32_t arrival) const;

  /// Whether all arrivals are equally long at the polygon's corners and centre.
  bool are_tied(const Polygon& polygon, const Eigen::Vector2d& centre, const Active& active) const;
  /// Length of the straight path of an arrival from its image.
  double straight_length(std::int32_t arrival, const Eigen::Vector2d& point) const;
  /// Distances of a point outside the bundle of paths of an arrival, on its two sides; negative inside.
  struct Outside {
    double begin, end;
  };
  Outside outside(std::int32_t arrival, const Eigen::Vector2d& point) const;

  const FaceDistances& distances_;
  double size_;
  Visit visit_;
  int halvings_ = 0;   ///< halvings of the present polygon so far
  int divisions_ = 0;  ///< its divisions along lines so far, halvings included
  std::vector<Sliver> slivers_;
};

}  // namespace supple::voronoi
