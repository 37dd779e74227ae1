#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "network_state.h"
#include "supple/base/execution.h"
#include "supple/embedded/host.h"
#include "supple/meshing/tetrahedral_mesh.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// The host of a network in the form that the solver reads: its nodes, the energies of their displacements, and the
/// coordinates that are fixed. A rigid or moving host has no nodes.
class HostModel {
 public:
  /// A solid is filled with tetrahedra, which takes most of the time. Throws "host.invalid" (a number out of range),
  /// "host.fixed_vertex" (no vertex of the mesh), "host.moved_vertex" (no vertex of the mesh, fixed, or named twice; a
  /// position that is not finite), "host.open_surface", "host.unsupported" (gravity or moved vertices on a part that
  /// can move as a whole) and what meshing::fill throws.
  HostModel(const surface::TriangleMesh& mesh, const Host& host, const Execution& execution);

  bool is_deformable() const { return nodes_.size() > 0; }
  /// Coordinates at rest, three for each node: first the mesh's vertices, then those inside.
  const Eigen::VectorXd& nodes() const { return nodes_; }
  const std::vector<std::shared_ptr<numerics::Term<NetworkState>>>& terms() const { return terms_; }
  /// For each coordinate of the nodes whether it is fixed.
  const std::vector<bool>& fixed() const { return fixed_; }
  /// The stiffness against displacements of single nodes, energy per squared mesh unit. Rounding is relative to it.
  double stiffness() const { return stiffness_; }
  /// Number of parts that no fixed vertices keep from moving as a whole. Constraints on six coordinates of each of them
  /// prevent that; these take no force.
  int rigid_body_constraints() const { return rigid_body_constraints_; }
  /// Vertices that are moved to prescribed positions. Their coordinates count as fixed, too.
  const std::vector<MovedVertex>& moved() const { return moved_; }
  const meshing::TetrahedralMesh& tetrahedra() const { return tetrahedra_; }  ///< elements of a solid; else empty

 private:
  void make_shell(const surface::TriangleMesh& mesh, const ShellHost& shell);
  void make_solid(const surface::TriangleMesh& mesh, const SolidHost& solid, const Execution& execution);
  void place_nodes(std::span<const Eigen::Vector3d> positions);
  void fix(std::int32_t node);
  void fix_vertices(const std::vector<std::int32_t>& fixed, const std::vector<MovedVertex>& moved);
  /// Fixes nodes without an element, and constrains the parts that can move as a whole.
  template <class Element>
  void constrain_parts(const std::vector<Element>& elements, bool is_loaded);
  void constrain_part(const std::vector<std::size_t>& nodes, bool is_loaded, bool is_moved);
  bool is_fixed(std::size_t node) const { return fixed_[3 * node] && fixed_[3 * node + 1] && fixed_[3 * node + 2]; }
  Eigen::Vector3d position(std::size_t node) const { return nodes_.segment<3>(3 * static_cast<Eigen::Index>(node)); }

  Eigen::VectorXd nodes_;
  std::vector<std::shared_ptr<numerics::Term<NetworkState>>> terms_;
  std::vector<bool> fixed_;
  double stiffness_ = 0;
  int rigid_body_constraints_ = 0;
  std::vector<MovedVertex> moved_;
  meshing::TetrahedralMesh tetrahedra_;
};

}  // namespace supple::embedded
