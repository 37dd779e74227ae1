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

/// What carries a network as the solver takes it: nodes, the terms that resist their motion, and the coordinates that
/// stay what they are.
class HostModel {
 public:
  /// A solid is filled with tetrahedra, which takes its time. Throws "host.invalid" (a number out of range),
  /// "host.fixed_vertex" (no vertex of the mesh), "host.moved_vertex" (no vertex of the mesh, fixed, or named twice; a
  /// position that is not finite), "host.open_surface", "host.unsupported" (gravity or moved vertices on a part that
  /// can move as a whole) and what meshing::fill throws.
  HostModel(const surface::TriangleMesh& mesh, const Host& host, const Execution& execution);

  bool gives_way() const { return nodes_.size() > 0; }
  /// Coordinates at rest, three for each node: first the mesh's vertices, then those inside.
  const Eigen::VectorXd& nodes() const { return nodes_; }
  const std::vector<std::shared_ptr<numerics::Term<NetworkState>>>& terms() const { return terms_; }
  /// Whether each coordinate of a node is held.
  const std::vector<bool>& held() const { return held_; }
  /// The stiffness against motions of single nodes, energy per squared mesh unit. Rounding is relative to it.
  double stiffness() const { return stiffness_; }
  /// Nodes that are held to some directions, so that parts which nothing fixes cannot move as a whole. No force is
  /// needed for that.
  int supports() const { return supports_; }
  /// Those that are taken elsewhere: held, too.
  const std::vector<MovedVertex>& moved() const { return moved_; }
  const meshing::TetrahedralMesh& tetrahedra() const { return tetrahedra_; }  ///< of a solid; else empty

 private:
  void make_shell(const surface::TriangleMesh& mesh, const ShellHost& shell);
  void make_solid(const surface::TriangleMesh& mesh, const SolidHost& solid, const Execution& execution);
  void place_nodes(std::span<const Eigen::Vector3d> positions);
  void hold(const std::vector<std::int32_t>& fixed);
  void hold(const std::vector<MovedVertex>& moved);
  template <class Element>
  void support(const std::vector<Element>& elements, bool loaded);

  Eigen::VectorXd nodes_;
  std::vector<std::shared_ptr<numerics::Term<NetworkState>>> terms_;
  std::vector<bool> held_;
  double stiffness_ = 0;
  int supports_ = 0;
  std::vector<MovedVertex> moved_;
  meshing::TetrahedralMesh tetrahedra_;
};

}  // namespace supple::embedded
