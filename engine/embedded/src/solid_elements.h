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

/// The elastic energy of a solid of linear tetrahedra: E = sum V psi(F), with an element's volume V at rest, its
/// constant deformation gradient F, and the neo-Hookean density [Bonet2008, eq. 6.27]
///   psi = mu / 2 (tr C - 3) - mu log J + lambda / 2 log(J)^2,  C = F^T F, J = det F,
/// with Lame's constants in three dimensions, mu = Y / (2 (1 + nu)) and lambda = Y nu / ((1 + nu) (1 - 2 nu)), where Y
/// is Young's modulus. An element whose volume is not positive has an infinite energy.
///
/// Everything is computed from displacements and Green's strain, so that small strains are accurate to rounding also
/// where the solid has rotated. The elements lock (are too stiff in bending) from nu = 0.49 on, which a finer mesh
/// improves only slowly; see docs/bench/hosts.md.
///
/// O(tetrahedra), in parallel: value, gradient, Hessian and their summation take about 0.3 us for each.
class SolidElements : public numerics::Term<NetworkState> {
 public:
  /// `rest` is the solid at rest; its nodes are those of the states. Throws std::invalid_argument if a tetrahedron's
  /// volume is not positive.
  SolidElements(const meshing::TetrahedralMesh& rest, const SolidHost& solid);

  std::string_view name() const override { return "solid"; }
  /// The convex Hessian omits the negative eigenvalues of the density's Hessian by F, which are known in closed form
  /// [Teran2005].
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  /// Nine tenths of the step at which the first tetrahedron loses its volume.
  double largest_step(const NetworkState& state, const Eigen::VectorXd& step) const override;
  void bill(CostLedger& cost, double seconds) const override;

  /// The sum of the tetrahedra's volumes at a state.
  double volume(const NetworkState& state) const;
  /// The least J of all tetrahedra at a state: 1 at rest.
  double least_volume_ratio(const NetworkState& state) const;

 private:
  struct Element {
    std::array<std::int32_t, 4> nodes;
    /// The columns are the gradients of the barycentric coordinates of nodes 1 to 3 by the position at rest.
    Eigen::Matrix3d gradients;
    double volume;  ///< at rest
    double mu;
    double lambda;
  };
  struct Evaluated;
  Eigen::Matrix3d displacement_gradient(const Element& element, const NetworkState& state) const;
  void evaluate(const Element& element, const NetworkState& state, int order, bool convex, Evaluated& to) const;

  Eigen::VectorXd rest_;  ///< the nodes' coordinates at rest
  std::vector<Element> elements_;
};

/// The potential of a uniform force f per volume at rest: E = -sum w f.(x - X) over the nodes, with position x now and
/// X at rest. w is a quarter of the volume of the node's tetrahedra, which is exact for linear ones. E is 0 at rest.
/// O(nodes).
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
