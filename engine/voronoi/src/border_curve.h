#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "border_accuracy.h"
#include "face_distances.h"
#include "quadrature.h"

namespace supple::voronoi {

/// A border between two places of a face as a function over the straight line between them: arcs of hyperbolas, with
/// bends where the shortest paths from one of its sites come another way. A border that is no such function, or that
/// rises farther than the straight line is long, is lost; parts of it that are short enough are found.
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

  /// `size` is the longest side of the face with these corners.
  BorderCurve(const FaceDistances& distances, const std::array<Eigen::Vector2d, 3>& corners, double size,
              const BorderAccuracy& accuracy)
      : distances_(distances), corners_(corners), size_(size), accuracy_(accuracy) {}

  /// A place at which a border bends or through which it is drawn, and how far the sites on both sides are from there.
  struct Bend {
    Eigen::Vector2d place;
    double distance = 0;
  };

  /// Begins a border from one place to another, which has these sites on its left and right.
  void lay(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, std::int32_t left, std::int32_t right,
           const Active& active);

  /// Finds its bends, from its begin to its end: `all`, or those that make a difference to areas or to what is drawn.
  void find_bends(bool all);
  const std::vector<Bend>& bends() const { return bends_; }
  /// Goes on with the part between two bends or ends: `number` bends lie before it.
  void lay_part(std::size_t number, const Eigen::Vector2d& begin, const Eigen::Vector2d& end);

  /// Points of quadrature along the border or the part of it, which is to have no bends in between.
  const std::vector<Node>& nodes();
  /// Whether the part rises so far or so steeply over its straight line that three points of quadrature do not tell its
  /// length, and a place where it runs along the straight line, at which it is better divided.
  bool bulges();
  bool find_top(Bend& top) const;
  /// Places along the same, in their order, for drawing: straight lines between these and the two ends are no farther
  /// from the border than the accuracy says. After nodes().
  const std::vector<Bend>& arc();

  /// Whether since lay() a part of the border was not found: nodes lie on the straight line instead.
  bool is_lost() const { return lost_; }

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
  /// From the sites on the left and on the right.
  using Ways = std::array<Way, 2>;
  /// A place of the border, as a fraction of the straight line, and how paths come there.
  struct Stage {
    double fraction = 0;
    double height = 0;
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    Ways ways;
  };

  void lay_line(const Eigen::Vector2d& begin, const Eigen::Vector2d& end);
  const surface::FaceArrival* comes_straight(const Active& active) const;
  std::pair<double, double> heights_within_face(const Eigen::Vector2d& base) const;
  void measure(Point& point) const;
  double height_by(const Ways& ways, const Eigen::Vector2d& base, double height, double below, double above) const;
  bool find(double fraction, Point& point, const Ways* guess = nullptr) const;
  bool find_nodes(double begin, double height_at_begin, double end, double height_at_end, int halvings);
  const std::vector<Node>& take_straight_nodes();
  bool is_function() const;
  double slope_at(const Eigen::Vector2d& place) const;
  bool has_known_ways() const;
  bool is_visible(double deviation) const;
  void add_arc(double begin, double height_at_begin, double end, double height_at_end, int halvings);
  bool turns_near_ends(const Points& points) const;
  bool take_nodes(const Points& points, double begin, double end);

  Way way_of(const Slope& slope, const Eigen::Vector2d& place) const;
  Ways ways_at(const Point& point) const;
  Stage stage_of(double fraction, const Point& point) const;
  bool same(const Way& one, const Way& other) const;
  bool same(const Ways& one, const Ways& other) const;
  void add_bend(const Eigen::Vector2d& place, double distance, const Ways& before);
  bool find_end_stage(bool at_end, Stage& stage) const;
  bool find_bend_by_ends();
  bool find_bends_by_probes(bool all, bool probed);
  bool is_shortest_between(const Stage& first, const Stage& last, const Ways& ways, const Ways& others) const;
  bool find_bends_between(Stage first, const Stage& last, bool all);
  bool is_tangent(const Way& one, const Way& other) const;
  bool find_change(const Stage& first, const Stage& last, std::size_t side, Stage& change) const;
  bool leads_to(const Stage& first, const Stage& last) const;
  bool is_on_border(const Stage& stage, double tolerance) const;

  const FaceDistances& distances_;
  std::array<Eigen::Vector2d, 3> corners_;
  double size_;
  BorderAccuracy accuracy_;
  Eigen::Vector2d begin_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d way_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal_ = Eigen::Vector2d::Zero();
  double length_ = 0;
  std::int32_t left_ = -1;
  std::int32_t right_ = -1;
  Active from_left_, from_right_;  ///< the arrivals that matter along it
  bool bisects_ = false;           ///< images are as far from their sites, so that it is straight
  int other_images_ = 0;           ///< that paths from the sites may come from besides one for each
  std::vector<Bend> bends_;
  std::vector<Ways> ways_of_parts_;   ///< how paths come to each part between bends
  const Ways* known_ways_ = nullptr;  ///< of the part, where it is one
  bool has_nodes_ = false;
  bool lost_ = false;
  bool surely_shortest_ = false;  ///< whether no paths but those of ways_of_parts_ can be shorter
  std::vector<Node> nodes_;
  std::vector<Bend> arc_;
  Points probes_;  ///< where areas have been tried without bends
};

}  // namespace supple::voronoi
