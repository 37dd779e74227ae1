#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "face_distances.h"
#include "polygon_integrals.h"

namespace supple::voronoi {

/// A convex part of a face that the paths of one arrival reach straight and before all others.
struct StraightRegion {
  std::int32_t arrival = -1;
  std::span<const Eigen::Vector2d> corners;
};

/// What a border that is a curve takes from the polygon on the one side of a straight line between two of its points
/// and gives to the other: points of quadrature of the area between the two.
struct Sliver {
  std::int32_t loses = -1;  ///< arrival
  std::int32_t gains = -1;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double area = 0;  ///< negative where it is the other way round
};

/// Divides convex polygons of a face into the regions of the arrivals of one site: where paths from one image of it
/// are the shortest, the squared distance from the site is a polynomial, or nearly so.
///
/// Two images that are equally far from the site are equally near along a straight line, and a bundle of paths ends at
/// straight lines, too: most regions are found exactly. Else the border of two regions is an arc of a hyperbola, which
/// is cut into short chords; a sliver for each of their points of quadrature makes up for what lies between.
class StraightRegions {
 public:
  /// `size` is that of the face, to which places are told apart by rounding.
  StraightRegions(const FaceDistances& distances, double size) : distances_(distances), size_(size) {}

  /// The regions of `active`, arrivals of one site, within a polygon, after those of polygons before. O(arrivals^2) for
  /// each region.
  void divide(std::span<const Eigen::Vector2d> polygon, const Active& active);
  void clear();

  std::size_t count() const { return regions_.size(); }
  StraightRegion region(std::size_t i) const;
  const std::vector<Sliver>& slivers() const { return slivers_; }

 private:
  struct Stored {
    std::int32_t arrival;
    std::size_t first_corner;
    std::size_t corners;
  };

  void divide(const Polygon& polygon, const Active& active, int depth);
  /// Whether two halves of the polygon, on both sides of a line on which paths of some arrival end, have been divided.
  bool divided_by_bundles(const Polygon& polygon, const Active& active, int depth);
  void divide_by_line(const Polygon& polygon, const Eigen::Vector2d& normal, double offset, const Active& active,
                      int depth);
  void halve(const Polygon& polygon, const Active& active, int depth);
  /// Drops arrivals that are nowhere shorter than another of `active` that all of the polygon sees.
  void drop_longer(const Polygon& polygon, Active& active) const;
  void divide_by_bisectors(const Polygon& polygon, const Active& active);
  /// The regions of two arrivals; false where the border between them bends too much, and nothing is added.
  bool divide_by_curve(const Polygon& polygon, std::int32_t one, std::int32_t other);
  void add(const Polygon& polygon, std::int32_t arrival);

  bool are_tied(const Polygon& polygon, const Eigen::Vector2d& centre, const Active& active) const;
  double straight_length(std::int32_t arrival, const Eigen::Vector2d& point) const;
  /// How far a point lies outside the bundle of paths of an arrival, on its two sides.
  struct Outside {
    double begin, end;
  };
  Outside outside(std::int32_t arrival, const Eigen::Vector2d& point) const;

  const FaceDistances& distances_;
  double size_;
  int halvings_ = 0;  ///< of the polygon that is being divided
  std::vector<Stored> regions_;
  std::vector<Eigen::Vector2d> corners_;
  std::vector<Sliver> slivers_;
};

}  // namespace supple::voronoi
