#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "face_distances.h"
#include "quadrature.h"

namespace supple::voronoi {

/// A border between two places of a face as a function over the straight line between them: parts of hyperbolas, with
/// bends where the shortest paths from one of its sites come another way. Two points of one border are so near to each
/// other that it bulges by less than a quarter of their distance.
class BorderCurve {
 public:
  /// A place of the border.
  struct Point {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    double height = 0;   ///< over the straight line, on its left
    double stretch = 1;  ///< how much longer than the straight line the border is here
    Slope left{}, right{};
  };
  /// A point of quadrature, and the fraction of the straight line that it stands for.
  struct Node {
    Point point;
    double weight = 0;
  };

  /// `size` is the longest side of the face with these corners, and `area_tolerance` what quadrature may leave of the
  /// area between a part of a border and its straight line, in squared mesh units.
  BorderCurve(const FaceDistances& distances, const std::array<Eigen::Vector2d, 3>& corners, double size,
              double area_tolerance)
      : distances_(distances), corners_(corners), size_(size), area_tolerance_(area_tolerance) {}

  /// Begins a border from one place to another, which has these sites on its left and right.
  void lay(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, std::int32_t left, std::int32_t right,
           const Active& active);

  /// Where it bends, from its begin to its end: `all` bends, or those that make a difference to areas.
  void find_bends(bool all, std::vector<Eigen::Vector2d>& bends);

  /// Points of quadrature along it, which is to have no bends in between.
  const std::vector<Node>& nodes();

  /// Of the straight line.
  double length() const { return length_; }
  /// To the left of the straight line.
  const Eigen::Vector2d& normal() const { return normal_; }

 private:
  using Points = std::array<Point, three_nodes.size()>;

  /// How paths from a site come to a place: straight from `turn`, which is `length` from the site.
  struct Way {
    Eigen::Vector2d turn = Eigen::Vector2d::Zero();
    double length = 0;

    double length_to(const Eigen::Vector2d& place) const { return length + (place - turn).norm(); }
  };
  /// A place of the border, as a fraction of the straight line, and the ways from both sites: left, right.
  struct Stage {
    double fraction = 0;
    double height = 0;
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    std::array<Way, 2> ways;
  };

  double sigma_of(const Active& active) const;
  bool comes_straight(const Active& active) const;
  std::pair<double, double> heights_within_face(const Eigen::Vector2d& base) const;
  bool find(double fraction, Point& point) const;
  bool find_nodes(double begin, double height_at_begin, double end, double height_at_end, int halvings);
  bool turns_near_ends(const Points& points) const;
  bool take_nodes(const Points& points, double begin, double end);

  Way way_of(const Slope& slope, const Eigen::Vector2d& place) const;
  Stage stage_of(double fraction, const Point& point) const;
  bool same(const Way& one, const Way& other) const;
  bool same(const std::array<Way, 2>& one, const std::array<Way, 2>& other) const;
  bool find_bends_between(Stage first, const Stage& last, bool all, std::vector<Eigen::Vector2d>& bends) const;
  bool is_tangent(const Way& one, const Way& other) const;
  bool find_change(const Stage& first, const Stage& last, std::size_t side, Stage& change) const;
  bool is_on_border(const Stage& stage) const;

  const FaceDistances& distances_;
  std::array<Eigen::Vector2d, 3> corners_;
  double size_;
  double area_tolerance_;
  Eigen::Vector2d begin_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d way_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal_ = Eigen::Vector2d::Zero();
  double length_ = 0;
  std::int32_t left_ = -1;
  std::int32_t right_ = -1;
  Active from_left_, from_right_;  ///< the arrivals that matter along it
  bool bisects_ = false;           ///< images are as far from their sites, so that it is straight
  int other_images_ = 0;           ///< that paths from the sites may come from besides one for each
  bool has_nodes_ = false;
  std::vector<Node> nodes_;
  Points probes_;  ///< where areas have been tried without bends
};

}  // namespace supple::voronoi
