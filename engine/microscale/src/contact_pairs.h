#pragma once

#include <Eigen/Core>
#include <vector>

#include "contact_outline.h"
#include "contact_search.h"

namespace supple::microscale {

/// A point of the outline and an image of a segment that come near each other.
struct ContactPair {
  int point = 0;  ///< the point's node of the mesh
  int tail = 0;   ///< nodes of the segment's ends
  int head = 0;
  int segment = 0;             ///< index into the outline's segments
  Eigen::Vector2i tail_shift;  ///< lattice shifts of the segment's ends relative to the point
  Eigen::Vector2i head_shift;
  Eigen::Vector2d rest_tail;  ///< rest positions of the ends minus that of the point, mm
  Eigen::Vector2d rest_head;
  double range = 0;         ///< distance at which contact begins, mm
  double length = 0;        ///< rest length of outline assigned to the point, mm
  bool tail_joint = false;  ///< whether there is a joint of the same range at the tail
  bool head_joint = false;  ///< whether there is a joint of the same range at the head
};

/// The common end of two consecutive segments that form pairs with the same point.
struct ContactJoint {
  int before = 0;    ///< index of the pair whose segment ends at the joint
  int after = 0;     ///< index of the pair whose segment begins at the joint
  double range = 0;  ///< the lesser of the pairs' ranges, mm
};

/// The ends of a pair's segment relative to the pair's point. For a state they are positions, for a step their changes.
struct PlacedSegment {
  /// `gradient` is F for a state, and the change of F for a step.
  PlacedSegment(const ContactPair& pair, const Eigen::Matrix2d& gradient, const Eigen::VectorXd& x)
      : tail(gradient * pair.rest_tail + x.segment<2>(2 * pair.tail) - x.segment<2>(2 * pair.point)),
        head(gradient * pair.rest_head + x.segment<2>(2 * pair.head) - x.segment<2>(2 * pair.point)) {}

  Eigen::Vector2d tail;
  Eigen::Vector2d head;
};

/// Finds the pairs that come within their range on a step. They are taken from a Verlet list, which has all pairs
/// within a margin of their range at a reference state. The list is complete until points have moved across the margin.
///
/// Motion since the reference state is measured relative to the affine motion of the patch, y -> y + G y. Two points at
/// a distance d approach each other by at most |G| d + |v_1| + |v_2| with the drifts v = dw - G w. Macroscopic strain
/// alone, which moves distant images far, therefore requires no new list.
class ContactPairs {
 public:
  /// `range` and `rest_fraction` as in ContactOptions.
  ContactPairs(const tiling::PeriodicMesh& mesh, double range, double rest_fraction);

  /// Sets the range and deletes all pairs.
  void set_range(double range);

  /// Finds the pairs of a step; see ContactBarrier::prepare_step.
  double prepare(const Eigen::VectorXd& x, const Eigen::VectorXd& step);

  const ContactOutline& outline() const { return outline_; }
  /// Pairs that come within their range on the step, ordered by point, segment and image.
  const std::vector<ContactPair>& pairs() const { return pairs_; }
  const std::vector<ContactJoint>& joints() const { return joints_; }

 private:
  /// An image of a segment that is near a point.
  struct Neighbour {
    int segment = 0;
    Eigen::Vector2i shift;
    double range = 0;
    double distance = 0;  ///< distance at the reference state
    bool operator<(const Neighbour& other) const;
  };
  /// The deformation of the patch in a state, or its change in a step.
  struct Deformation {
    Eigen::Matrix2d gradient;       ///< F, or its change
    Eigen::Matrix2Xd displacement;  ///< periodic displacements w of the outline's points, or their changes
  };

  void bound_drift();
  /// Raises affine_norm_ and drift_ to those of a state with G = `affine` and v = relative_displacement_.
  void raise_drift_bounds(const Eigen::Matrix2d& affine);
  /// Whether the list has all pairs that can come within their range on the step.
  bool list_is_complete() const;
  /// Makes the start of the step the reference state. Also shortens the step if it is too long for a local search.
  void rebuild_list();
  void find_neighbours(int point);
  double segment_drift(const ContactOutline::Segment& segment) const;
  /// Distance at which contact begins, mm; 0 if point and segment touch at rest.
  double pair_range(int point, const ContactOutline::Segment& segment, const Eigen::Vector2i& shift) const;
  /// Adds the pair if it can come within its range on the step, and reduces safe_fraction_ for it.
  void add_pair_if_near(int point, const Neighbour& neighbour);
  /// Adds the joints between the pairs from index `first` on, which are those of one point.
  void add_joints_from(std::size_t first);

  ContactOutline outline_;
  double range_;
  double rest_fraction_;
  SegmentGrid grid_;

  // The reference state and its list.
  bool has_list_ = false;
  Deformation reference_;
  Eigen::Matrix2d reference_inverse_;     ///< F^-1
  Eigen::Matrix2d reference_lattice_;     ///< deformed translations
  Eigen::Matrix2Xd reference_positions_;  ///< positions of the outline's points
  std::vector<Neighbour> list_;           ///< sorted by points
  std::vector<std::size_t> list_begin_;   ///< index of each point's first entry, and the list's size

  // The step that is prepared.
  Deformation start_;
  Deformation change_;
  double safe_fraction_ = 1;                ///< fraction of the step that may be taken
  double affine_norm_ = 0;                  ///< bound of |G| on the step
  std::vector<double> drift_;               ///< bound of |v| on the step for each point, mm
  double largest_drift_ = 0;                ///< the largest entry of drift_
  Eigen::Matrix2Xd relative_displacement_;  ///< v of each point at one end of the step, mm
  std::vector<Neighbour> neighbours_;       ///< neighbours of one point
  std::vector<ContactPair> pairs_;
  std::vector<ContactJoint> joints_;
};

}  // namespace supple::microscale
