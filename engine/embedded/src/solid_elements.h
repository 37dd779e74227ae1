#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "network_state.h"
#include "supple/embedded/host.h"
#include "supple/meshing/tetrahedral_mesh.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// The elastic energy of a solid of linear tetrahedra: E = sum V psi(F), with the volume V at rest, the deformation
/// gradient F that is constant in each, and the neo-Hookean density of Bonet and Wood (2008, eq. 6.27)
///   psi = mu / 2 (tr C - 3) - mu log J + lambda / 2 log(J)^2,  C = F^T F, J = det F,
/// with Lame's constants of space, mu = E / 2 (1 + nu) and lambda = E nu / (1 + nu)(1 - 2 nu). A tetrahedron that has
/// lost its volume has an infinite energy.
///
/// Small strains keep their digits, also where the solid has turned: everything is written by the displacements and
/// Green's strain. What these elements cannot do is keep their volume and bend at the same time: from nu = 0.49 on they
/// are too stiff (they lock), which a finer mesh mends slowly; see docs/bench/solids.md.
///
/// O(tetrahedra), in parallel: about 0.3 us each for value, gradient and Hessian with their sum.
class SolidElements : public numerics::Term<NetworkState> {
 public:
  /// At rest where `rest` is, whose nodes are the state's. Throws std::invalid_argument where a tetrahedron has no
  /// volume.
  SolidElements(const meshing::TetrahedralMesh& rest, const SolidHost& solid);

  std::string_view name() const override { return "solid"; }
  /// The Hessian without its negative eigenvalues in the deformation gradient (Teran, Sifakis, Irving and Fedkiw 2005),
  /// which are known in closed form.
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  /// Nine tenths of the way to the first tetrahedron's loss of its volume.
  double largest_step(const NetworkState& state, const Eigen::VectorXd& step) const override;
  void bill(CostLedger& cost, double seconds) const override;

  /// The volume of all tetrahedra at a state.
  double volume(const NetworkState& state) const;
  /// The least J of all tetrahedra at a state: 1 at rest.
  double least_volume_ratio(const NetworkState& state) const;

 private:
  struct Element {
    std::array<std::int32_t, 4> nodes;
    Eigen::Matrix3d gradients;  ///< columns: of the barycentric coordinates of nodes 1 to 3, by the place at rest
    double volume;              ///< at rest
    double mu;
    double lambda;
  };
  struct Evaluated;
  Eigen::Matrix3d displacement_gradient(const Element& element, const NetworkState& state) const;
  void evaluate(const Element& element, const NetworkState& state, int order, bool convex, Evaluated& to) const;

  Eigen::VectorXd rest_;  ///< coordinates of the nodes
  std::vector<Element> elements_;
};

/// A force per volume at rest that is the same everywhere: E = -sum w f.(x - X) over the nodes at x, at X at rest, each
/// with a fourth of its tetrahedra's volumes as w (exact for linear tetrahedra). 0 at rest. O(nodes).
class Gravity : public numerics::Term<NetworkState> {
 public:
  Gravity(const meshing::TetrahedralMesh& rest, const Eigen::Vector3d& force);

  std::string_view name() const override { return "gravity"; }
  bool active() const override { return !force_.isZero(0); }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  Eigen::VectorXd rest_;
  std::vector<double> weights_;
  Eigen::Vector3d force_;
};

}  // namespace supple::embedded
