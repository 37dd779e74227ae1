#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "element_energies.h"
#include "network_state.h"
#include "supple/embedded/host.h"
#include "supple/numerics/term.h"

namespace supple::embedded {

/// The stretching of a shell's faces: E = thickness * area * psi of the face's Cauchy-Green tensor, neo-Hookean (thesis
/// eq. 3.20) with the constants of plane stress, mu = E / 2 (1 + nu) and lambda = E nu / (1 - nu^2). The face's area at
/// rest is the mesh's as it is given. A face that loses its area has an infinite energy. O(faces), in parallel.
class ShellMembrane : public numerics::Term<NetworkState> {
 public:
  ShellMembrane(const surface::TriangleMesh& rest, const ShellHost& shell);

  std::string_view name() const override { return "shell_membrane"; }
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  struct Face {
    std::array<std::int32_t, 3> nodes;
    TriangleEnergy energy;
  };
  std::vector<Face> faces_;
};

/// The bending of a shell's inner edges: E = sum D / 2 * l^2 / A * (theta - theta_rest)^2 with the angle theta between
/// the normals of an edge's two faces (Grinspun et al. 2003), the edge's length l and the faces' area A at rest, and
/// the bending stiffness D = E h^3 / 12 (1 - nu^2).
///
/// A sheet of equilateral triangles that is rolled to a cylinder has exactly the energy of the plate. Curved both ways,
/// hinges act as a plate with Poisson's ratio -1/3, whatever the material's: they know the angle of each edge and not
/// how two neighbouring ones bend together. O(edges), in parallel.
class ShellHinges : public numerics::Term<NetworkState> {
 public:
  ShellHinges(const surface::TriangleMesh& rest, const ShellHost& shell);

  std::string_view name() const override { return "shell_bending"; }
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  struct Hinge {
    std::array<std::int32_t, 4> nodes;  ///< the edge's tail and head, the corners on its left and on its right
    double weight;                      ///< of the squared change of the angle
    double rest_angle;
  };
  std::vector<Hinge> hinges_;
};

/// The enclosed volume: E = w / 2 * (V - scale V0)^2 / V0, V0 the volume at rest. All nodes are coupled: the Hessian is
/// sparse but for one product. O(faces).
class ShellVolume : public numerics::Term<NetworkState> {
 public:
  /// Throws "host.open_surface" where the surface does not enclose a volume.
  ShellVolume(const surface::TriangleMesh& rest, const ShellHost& shell);

  std::string_view name() const override { return "shell_volume"; }
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  std::vector<surface::Triangle> faces_;
  double rest_volume_ = 0;
  double weight_;
  double scale_;
};

/// The angle between the normals of two faces on an edge, in (-pi, pi], positive where the edge is a ridge seen from
/// the side to which the normals point, with its derivatives by the edge's tail and head and the corners on its left
/// and on its right, seen with the edge going up. The faces have areas.
struct HingeAngle {
  double angle = 0;
  Eigen::Matrix<double, 12, 1> gradient = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Matrix<double, 12, 12> hessian = Eigen::Matrix<double, 12, 12>::Zero();
};
HingeAngle hinge_angle(const std::array<Eigen::Vector3d, 4>& corners, int order);

}  // namespace supple::embedded
