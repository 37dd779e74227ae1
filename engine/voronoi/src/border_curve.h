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

/// A border between two places of a face, as a height over its chord, the straight line between them. It consists of
/// arcs of hyperbolas, with bends where the shortest paths from one of its sites change their pseudo-source. Tracing
/// fails if the border is no such function, or higher than the chord is long. Short enough parts of it can be traced.
class BorderCurve {
 public:
  /// A point of the border.
  struct Point {
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    double height = 0;   ///< over the chord, positive on its left
    double stretch = 1;  ///< length of the border per length of the chord at this point
    SiteDistance left{}, right{};
  };
  /// A quadrature point, and its weight as a fraction of the chord.
  struct Node {
    Point point;
    double weight = 0;
  };

  /// `size` is the longest side of the face; `corners` are the face's.
  BorderCurve(const FaceDistances& distances, const std::array<Eigen::Vector2d, 3>& corners, double size,
              const BorderAccuracy& accuracy)
      : distances_(distances), corners_(corners), size_(size), accuracy_(accuracy) {}

  /// A place at which the border bends or is drawn, and its distance from both sites.
  struct Bend {
    Eigen::Vector2d place;
    double distance = 0;
  };

  /// Sets the border to be traced: its ends and the sites on its left and right.
  void set_border(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, std::int32_t left, std::int32_t right,
                  const Active& active);

  /// Finds the bends in order along the border: all, or those that matter for areas and drawing.
  void find_bends(bool all);
  const std::vector<Bend>& bends() const { return bends_; }
  /// Restricts the following queries to the part between two successive bends or ends, which `number` bends precede.
  void set_part(std::size_t number, const Eigen::Vector2d& begin, const Eigen::Vector2d& end);

  /// Quadrature points along the border or the part that set_part has chosen, which must have no bends.
  const std::vector<Node>& nodes();
  /// Whether the part is so high or so steep over its chord that three quadrature points do not give its length.
  bool needs_division();
  /// Finds a place where the part is nearly parallel to its chord, to divide it there.
  bool find_top(Bend& top) const;
  /// Places along the part for drawing, in order. The polyline through them and the ends has the required accuracy.
  /// Call nodes() first.
  const std::vector<Bend>& arc();

  /// Whether any part of the border could not be traced since set_border(). Its nodes then lie on the chord.
  bool has_failed() const { return failed_; }

  /// Length of the chord.
  double length() const { return length_; }
  /// Unit normal of the chord, to its left.
  const Eigen::Vector2d& normal() const { return normal_; }

 private:
  using Points = std::array<Point, three_nodes.size()>;

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

  void set_chord(const Eigen::Vector2d& begin, const Eigen::Vector2d& end);
  const surface::FaceArrival* straight_arrival(const Active& active) const;
  std::pair<double, double> heights_within_face(const Eigen::Vector2d& base) const;
  void measure(Point& point) const;
  double equidistant_height(const PseudoSources& sources, const Eigen::Vector2d& base, double height, double below,
                            double above) const;
  bool find_point(double fraction, Point& point, const PseudoSources* guess = nullptr) const;
  bool find_nodes(double begin, double height_at_begin, double end, double height_at_end, int halvings);
  const std::vector<Node>& use_straight_nodes();
  bool lies_over_chord() const;
  double slope_at(const Eigen::Vector2d& place) const;
  bool is_reached_from_part_sources() const;
  bool is_visible(double deviation) const;
  void add_arc(double begin, double height_at_begin, double end, double height_at_end, int halvings);
  bool has_bends_near_ends(const Points& points) const;
  bool append_nodes(const Points& points, double begin, double end);

  PseudoSource pseudo_source_of(const SiteDistance& shortest, const Eigen::Vector2d& place) const;
  PseudoSources pseudo_sources_at(const Point& point) const;
  LabelledPoint labelled(double fraction, const Point& point) const;
  bool same(const PseudoSource& one, const PseudoSource& other) const;
  bool same(const PseudoSources& one, const PseudoSources& other) const;
  void add_bend(const Eigen::Vector2d& place, double distance, const PseudoSources& before);
  bool find_labelled_end(bool at_end, LabelledPoint& result) const;
  bool find_bend_by_ends();
  bool find_bends_by_probes(bool all, bool probed);
  bool is_shortest_between(const LabelledPoint& first, const LabelledPoint& last, const PseudoSources& sources,
                           const PseudoSources& others) const;
  bool find_bends_between(LabelledPoint first, const LabelledPoint& last, bool all);
  bool is_smooth_transition(const PseudoSource& one, const PseudoSource& other) const;
  bool find_transition(const LabelledPoint& first, const LabelledPoint& last, std::size_t side,
                       LabelledPoint& transition) const;
  bool has_no_bend_between(const LabelledPoint& first, const LabelledPoint& last) const;
  bool is_on_border(const LabelledPoint& point, double tolerance) const;

  const FaceDistances& distances_;
  std::array<Eigen::Vector2d, 3> corners_;
  double size_;
  BorderAccuracy accuracy_;
  Eigen::Vector2d begin_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d chord_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal_ = Eigen::Vector2d::Zero();
  double length_ = 0;
  std::int32_t left_ = -1;
  std::int32_t right_ = -1;
  Active from_left_, from_right_;  ///< arrivals that may be the shortest along the border
  /// Whether both pseudo-sources are equally far from their sites, so that the border is straight.
  bool is_bisector_ = false;
  int extra_images_ = 0;  ///< number of images from which paths may come, minus one for each site
  std::vector<Bend> bends_;
  std::vector<PseudoSources> sources_of_parts_;  ///< pseudo-sources of each part between bends
  const PseudoSources* part_sources_ = nullptr;  ///< those of the current part; null if not known
  bool has_nodes_ = false;
  bool failed_ = false;
  bool excludes_other_paths_ = false;  ///< whether paths from other pseudo-sources are proven to be no shorter
  std::vector<Node> nodes_;
  std::vector<Bend> arc_;
  Points probes_;  ///< points of a quadrature that ignored bends
};

}  // namespace supple::voronoi
