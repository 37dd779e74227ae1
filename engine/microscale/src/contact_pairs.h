#pragma once

#include <Eigen/Core>
#include <vector>

#include "contact_outline.h"
#include "contact_search.h"

namespace supple::microscale {

/// A point of the outline and a segment (an image of one) that come near each other.
struct ContactPair {
  int point = 0;  ///< nodes of the mesh
  int tail = 0;
  int head = 0;
  int segment = 0;             ///< index into the outline's segments
  Eigen::Vector2i tail_shift;  ///< cells of the segment's ends, seen from the point's
  Eigen::Vector2i head_shift;
  Eigen::Vector2d rest_tail;  ///< rest positions of the ends minus that of the point, mm
  Eigen::Vector2d rest_head;
  double range = 0;         ///< distance at which contact begins, mm
  double length = 0;        ///< the point's share of the outline, mm
  bool tail_joint = false;  ///< whether a joint of the same range stands at the end
  bool head_joint = false;
};

/// Two pairs of one point whose segments follow each other.
struct ContactJoint {
  int before = 0;    ///< index of the pair whose head it is
  int after = 0;     ///< of the pair whose tail it is
  double range = 0;  ///< mm, the lesser of the pairs' ranges
};

/// The ends of a pair's segment in a state, or their changes in a step, relative to the point.
struct PlacedSegment {
  /// `gradient`: F, or the change of it for a step.
  PlacedSegment(const ContactPair& pair, const Eigen::Matrix2d& gradient, const Eigen::VectorXd& x)
      : tail(gradient * pair.rest_tail + x.segment<2>(2 * pair.tail) - x.segment<2>(2 * pair.point)),
        head(gradient * pair.rest_head + x.segment<2>(2 * pair.head) - x.segment<2>(2 * pair.point)) {}

  Eigen::Vector2d tail;
  Eigen::Vector2d head;
};

/// Finds the pairs that come within their range on a step. They come from a Verlet list of all pairs within a margin of
/// their range at a reference state, which serves until points have moved across the margin.
///
/// That motion is measured against the affine motion of the patch, y -> y + G y: two points at a distance d approach by
/// at most |G| d + |v_1| + |v_2| with v = dw - G w. So macroscopic strain alone, which moves far images far, costs no
/// new list.
class ContactPairs {
 public:
  /// `range` and `rest_fraction` as in ContactOptions.
  ContactPairs(const tiling::PeriodicMesh& mesh, double range, double rest_fraction);

  /// Forgets all pairs.
  void set_range(double range);

  /// See ContactBarrier::prepare.
  double prepare(const Eigen::VectorXd& x, const Eigen::VectorXd& step);

  const ContactOutline& outline() const { return outline_; }
  /// Pairs that come within their range on the step, ordered by point, segment and image.
  const std::vector<ContactPair>& pairs() const { return pairs_; }
  const std::vector<ContactJoint>& joints() const { return joints_; }

 private:
  /// A segment that a point has near it.
  struct Neighbour {
    int segment = 0;
    Eigen::Vector2i shift;
    double range = 0;
    double distance = 0;  ///< at the reference state
    bool operator<(const Neighbour& other) const;
  };
  /// The patch in a state, or its change in a step.
  struct Motion {
    Eigen::Matrix2d gradient;       ///< F
    Eigen::Matrix2Xd displacement;  ///< w of the outline's points
  };

  void measure_drift();
  void raise_drift(const Eigen::Matrix2d& affine);
  bool list_serves() const;
  void renew_list();
  void find_neighbours(int point);
  double segment_drift(const ContactOutline::Segment& segment) const;
  double pair_range(int point, const ContactOutline::Segment& segment, const Eigen::Vector2i& shift) const;
  void take_if_near(int point, const Neighbour& neighbour);
  void join_pairs_from(std::size_t first);

  ContactOutline outline_;
  double range_;
  double rest_fraction_;
  SegmentGrid grid_;

  // The reference state and its list.
  bool has_list_ = false;
  Motion reference_;
  Eigen::Matrix2d reference_inverse_;     ///< F^-1
  Eigen::Matrix2d reference_lattice_;     ///< deformed
  Eigen::Matrix2Xd reference_positions_;  ///< of the outline's points
  std::vector<Neighbour> list_;           ///< point by point
  std::vector<std::size_t> list_begin_;   ///< for each point, and the end

  // The step at work.
  Motion start_;
  Motion change_;
  double share_ = 1;           ///< of the step that is known to be safe
  double affine_ = 0;          ///< the largest |G| on it
  std::vector<double> drift_;  ///< for each point the largest |v| on it, mm
  double largest_drift_ = 0;
  Eigen::Matrix2Xd relative_;     ///< v
  std::vector<Neighbour> found_;  ///< of the point at work
  std::vector<ContactPair> pairs_;
  std::vector<ContactJoint> joints_;
};

}  // namespace supple::microscale
