#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "border_accuracy.h"
#include "border_bends.h"
#include "border_tracer.h"
#include "quadrature.h"

namespace supple::voronoi {

/// A border between two places of a face, as a height over its chord, the straight line between them. It consists of
/// arcs of hyperbolas, with bends where the shortest paths from one of its sites change their pseudo-source. Tracing
/// fails if the border is no such function, or higher than the chord is long. Short enough parts of it can be traced.
class BorderCurve {
 public:
  /// A quadrature point, and its weight as a fraction of the chord.
  struct Node {
    BorderPoint point;
    double weight = 0;
  };

  /// `size` is the longest side of the face; `corners` are the face's.
  BorderCurve(const FaceDistances& distances, const std::array<Eigen::Vector2d, 3>& corners, double size,
              const BorderAccuracy& accuracy)
      : tracer_(distances, corners, size), accuracy_(accuracy) {}

  /// Sets the border to be traced: its ends and the sites on its left and right.
  void set_border(const Eigen::Vector2d& begin, const Eigen::Vector2d& end, std::int32_t left, std::int32_t right,
                  const Active& active);

  /// Finds the bends in order along the border: all, or those that matter for areas and drawing.
  void find_bends(bool all);
  const std::vector<BorderBend>& bends() const { return bends_.bends; }
  /// Restricts the following queries to the part between two successive bends or ends, which `number` bends precede.
  void set_part(std::size_t number, const Eigen::Vector2d& begin, const Eigen::Vector2d& end);

  /// Quadrature points along the border or the part that set_part has chosen, which must have no bends.
  const std::vector<Node>& nodes();
  /// Whether the part is so high or so steep over its chord that three quadrature points do not give its length.
  bool needs_division();
  /// Finds a place where the part is nearly parallel to its chord, to divide it there.
  bool find_top(BorderBend& top) const;
  /// Places along the part for drawing, in order. The polyline through them and the ends has the required accuracy.
  /// Call nodes() first.
  const std::vector<BorderBend>& arc();

  /// Whether any part of the border could not be traced since set_border(). Its nodes then lie on the chord.
  bool has_failed() const { return failed_; }

  /// Length of the chord.
  double length() const { return tracer_.length(); }
  /// Unit normal of the chord, to its left.
  const Eigen::Vector2d& normal() const { return tracer_.normal(); }

 private:
  using Points = std::array<BorderPoint, three_nodes.size()>;

  void set_chord(const Eigen::Vector2d& begin, const Eigen::Vector2d& end);
  bool find_nodes(double begin, double height_at_begin, double end, double height_at_end, int halvings);
  const std::vector<Node>& use_straight_nodes();
  bool lies_over_chord() const;
  double slope_at(const Eigen::Vector2d& place) const;
  bool is_reached_from_part_sources() const;
  bool is_visible(double deviation) const;
  void add_arc(double begin, double height_at_begin, double end, double height_at_end, int halvings);
  bool has_bends_near_ends(const Points& points) const;
  bool append_nodes(const Points& points, double begin, double end);

  BorderTracer tracer_;
  BorderAccuracy accuracy_;
  /// Whether both pseudo-sources are equally far from their sites, so that the border is straight.
  bool is_bisector_ = false;
  int extra_images_ = 0;  ///< number of images from which paths may come, minus one for each site
  BorderBends bends_;
  bool has_nodes_ = false;
  bool failed_ = false;
  bool excludes_other_paths_ = false;  ///< whether paths from other pseudo-sources are proven to be no shorter
  std::vector<Node> nodes_;
  std::vector<BorderBend> arc_;
  Points probes_;  ///< points of a quadrature that ignored bends
};

}  // namespace supple::voronoi
