#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "supple/microscale/part_simulation.h"
#include "supple/microscale/simulation_error.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// The displacements that the supports of a part hold. Degrees of freedom are numbered as in cell_coordinates.h,
/// without the macroscopic strain.
struct Constraints {
  static constexpr int none = -1;
  /// The displacement is fixed so that the part does not move along its plates.
  static constexpr int translation = -2;

  std::vector<int> support;    ///< for each degree of freedom the support that holds it, or one of the above
  std::vector<double> offset;  ///< mm; its displacement is that of the support plus this

  bool fixes(Eigen::Index dof) const { return support[static_cast<std::size_t>(dof)] != none; }
  std::vector<bool> fixed() const;
  bool operator==(const Constraints&) const = default;
};

/// The supports of a part's mesh: what they hold, where they are, and what they exert. A clamp holds its nodes always.
/// A plate holds the nodes that it pushes: these are found from one equilibrium to the next, see `corrected`.
class PartSupports {
 public:
  /// Throws "simulation.invalid_load". The mesh must outlive the supports.
  PartSupports(const tiling::PeriodicMesh& mesh, std::vector<Support> supports);

  const Constraints& at_rest() const { return at_rest_; }
  bool fixes_translation() const { return fixes_translation_; }
  /// The largest motion of a support relative to another one, divided by the length of the part along this motion.
  double largest_motion() const;

  /// Sets the displacements that are held to those at this fraction of the path.
  void impose(const Constraints& constraints, double fraction, Eigen::VectorXd& x) const;
  /// The change of all degrees of freedom for each unit of `fraction`; it is 0 for those that are not held.
  Eigen::VectorXd rate(const Constraints& constraints, Eigen::Index size) const;

  /// What the plates hold at an equilibrium instead of `constraints`: nodes that a plate pulls are released, and nodes
  /// that have passed its surface are held. None if `constraints` is right. `gradient` is that of the energy at x, and
  /// plates may pull by `force_tolerance`.
  enum class Scope {
    all_plates,
    one_plate,  ///< only the plate that pulls most, or the one that was passed farthest if none pulls
    one_node    ///< only the node that has passed a plate farthest, or the one that is pulled most if none has
  };
  std::optional<Constraints> corrected(const Constraints& constraints, const Eigen::VectorXd& x,
                                       const Eigen::VectorXd& gradient, double fraction, double force_tolerance,
                                       Scope scope) const;
  /// Whether the part can move as a rigid body without moving a displacement that is held.
  bool leaves_rigid_motion(const Constraints& constraints) const;

  /// A node that a plate may touch.
  struct Candidate {
    int node = 0;
    double length = 0;  ///< rest length of outline assigned to it, mm
  };
  /// A plate as part of the mesh.
  struct Surface {
    int support = 0;      ///< index of the support
    int axis = 0;         ///< the coordinate along its normal: 0 for x, 1 for y
    double sign = 1;      ///< the normal into the part is this times the axis
    double position = 0;  ///< coordinate of its surface at rest, mm
    bool sticks = false;
    double rate = 0;  ///< change of its position for each unit of `fraction`, mm
  };
  const std::vector<Surface>& surfaces() const { return surfaces_; }
  const std::vector<Candidate>& candidates() const { return candidates_; }
  /// The distance of a node from a plate, mm; negative if it has passed the surface.
  double gap(const Surface& surface, int node, const Eigen::VectorXd& x, double fraction) const;

  const tiling::PeriodicMesh& mesh() const { return mesh_; }
  std::size_t count() const { return supports_.size(); }
  /// The displacement of a support at the end of the path, mm; zero for a number that is none of a support.
  Eigen::Vector2d displacement(int support) const;

 private:
  void fix_clamped_nodes();
  void fix_touching_nodes();
  void fix_at(const Surface& surface, int node, double tangential_offset, Constraints& constraints) const;
  static void release_from(const Surface& surface, int node, Constraints& constraints);
  void check_collisions() const;
  /// Fixes one displacement if that prevents the only motion that is left, and if no support can act along it. Throws
  /// for all other motions that are left.
  void check_rigid_motions();
  /// A motion (along x, along y, around the middle) that moves nothing that is held; none if there is none.
  std::optional<Eigen::Vector3d> rigid_motion_along(const Constraints& constraints) const;
  /// Whether any support can hold displacements along an axis.
  bool may_fix_along(int axis) const;

  const tiling::PeriodicMesh& mesh_;
  std::vector<Support> supports_;
  Eigen::Vector2d lower_, upper_;  ///< the part's bounding box at rest, mm
  std::vector<Surface> surfaces_;
  std::vector<Candidate> candidates_;
  Constraints at_rest_;
  bool fixes_translation_ = false;
};

/// The error for supports that no part can have; `details` has at least one entry.
InvalidLoad invalid_supports(const std::vector<Error::Detail>& details);
/// Checks what can be checked without a mesh, for a part with this bounding box. Throws "simulation.invalid_load".
void check_supports(const std::vector<Support>& supports, const Eigen::Vector2d& lower, const Eigen::Vector2d& upper);

}  // namespace supple::microscale
