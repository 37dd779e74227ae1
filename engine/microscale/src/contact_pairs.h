#pragma once

#include <Eigen/Core>
#include <vector>

#include "cell_coordinates.h"
#include "contact_outline.h"
#include "contact_search.h"

namespace supple::microscale {

/// A point and a segment of the outline (an image of it) that come near each other.
struct ContactPair {
  int point = 0;  ///< nodes of the mesh
  int tail = 0;
  int head = 0;
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

/// Finds the pairs that come within their range on a step, in a Verlet list: all pairs within a margin of their range
/// at a reference state, which serves until points have moved across the margin.
///
/// Motion is measured relative to the affine motion of the patch, y -> y + G y: for two points at a distance d the
/// distance changes by at most |G| d + |v_1| + |v_2|, v = dw - G w. So a large macroscopic strain alone moves little.
class ContactPairs {
 public:
  ContactPairs(const tiling::PeriodicMesh& mesh, double range, double rest_fraction);

  /// See ContactBarrier::prepare. About 0.05 ms for 1000 points while the list serves, 0.5 ms to make a new one.
  double prepare(const Eigen::VectorXd& x, const Eigen::VectorXd& step);

  const ContactOutline& outline() const { return outline_; }
  /// Pairs that come within their range on the prepared step, sorted by point, segment and image.
  const std::vector<ContactPair>& pairs() const { return pairs_; }
  const std::vector<ContactJoint>& joints() const { return joints_; }

 private:
  /// A pair of the Verlet list.
  struct Neighbour {
    int segment = 0;
    Eigen::Vector2i shift;
    double range = 0;
    double distance = 0;  ///< at the reference state
  };
  struct Motion {
    double affine = 0;  ///< |G|
    double other = 0;   ///< the largest |v|
  };

  bool list_serves(const Eigen::VectorXd& x, const Eigen::VectorXd& step);
  void take_reference(const Eigen::VectorXd& x);
  Motion measure(const Eigen::Matrix2d& strain_change, const Eigen::Matrix2Xd& displacements, bool keep_larger);
  double renew_list(const Eigen::VectorXd& x, const Eigen::VectorXd& step);
  void find_neighbours(int point, double radius);
  double pair_range(int point, const ContactOutline::Segment& segment, const Eigen::Vector2i& shift) const;
  void consider(int point, const Neighbour& neighbour);
  void join(std::size_t first);
  double largest_share(double share) const;

  ContactOutline outline_;
  double range_;
  double rest_fraction_;
  SegmentGrid grid_;

  // The reference state and its list.
  bool have_reference_ = false;
  Eigen::Matrix2d reference_gradient_;        ///< F
  Eigen::Matrix2d reference_inverse_;         ///< F^-1
  Eigen::Matrix2Xd reference_displacements_;  ///< w of the points
  std::vector<Neighbour> list_;               ///< point by point
  std::vector<std::size_t> list_begin_;       ///< for each point, and the end
  std::vector<Neighbour> found_;              ///< of the point at work

  // The step at work: deformation gradient and displacements at its start, their changes.
  Eigen::Matrix2d gradient_;
  Eigen::Matrix2d gradient_change_;
  Eigen::Matrix2Xd displacements_;
  Eigen::Matrix2Xd displacement_changes_;
  Eigen::Matrix2Xd positions_;
  std::vector<double> motion_;  ///< |v| of each point, the larger of the step's two ends

  std::vector<ContactPair> pairs_;
  std::vector<int> pair_segments_;  ///< for each pair its segment
  std::vector<ContactJoint> joints_;
};

}  // namespace supple::microscale
