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

/// The stretching energy of a shell's faces: E = thickness * area * psi, where psi is the neo-Hookean density of the
/// face's Cauchy-Green tensor [Thesis, eq. 3.20]. With Young's modulus Y and Poisson's ratio nu its constants are those
/// of plane stress, mu = Y / (2 (1 + nu)) and lambda = Y nu / (1 - nu^2). The mesh as it is given is at rest, and
/// `area` is measured there. A face without area has an infinite energy. O(faces), in parallel.
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

/// The bending energy of a shell's inner edges [Grinspun2003]: E = sum D / 2 * l^2 / A * (theta - theta_rest)^2. theta
/// is the angle between the normals of an edge's two faces, l the edge's length and A the area of the two faces, both
/// at rest. The bending stiffness is D = Y h^3 / (12 (1 - nu^2)), with Young's modulus Y and the thickness h.
///
/// A sheet of equilateral triangles that is rolled to a cylinder has exactly the energy of the plate. Where both
/// principal curvatures change, hinges act as a plate with Poisson's ratio -1/3 for every material: each depends on its
/// own angle alone, and nothing couples neighbouring angles. O(edges), in parallel.
class ShellHinges : public numerics::Term<NetworkState> {
 public:
  ShellHinges(const surface::TriangleMesh& rest, const ShellHost& shell);

  std::string_view name() const override { return "shell_bending"; }
  bool has_convex_hessian() const override { return true; }
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;

 private:
  struct Hinge {
    std::array<std::int32_t, 4> nodes;  ///< the edge's tail and head, then the corners on its left and on its right
    double weight;                      ///< the energy for a squared change of the angle of 1 rad^2
    double rest_angle;                  ///< rad
  };
  std::vector<Hinge> hinges_;
};

/// The energy of the enclosed volume V: E = w / 2 * (V - scale V0)^2 / V0, with the volume V0 at rest, w =
/// ShellHost::volume_weight and scale = ShellHost::volume_scale. It couples all nodes: the Hessian is a sparse matrix
/// plus one of rank one. O(faces).
class ShellVolume : public numerics::Term<NetworkState> {
 public:
  /// Throws "host.open_surface" if the surface has a boundary.
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

/// The angle between the normals of two faces on an edge, in (-pi, pi], and its derivatives by the edge's tail, its
/// head, and the opposite corners on the left and on the right, as seen along the edge with the normals pointing up.
/// The angle is positive if the edge is a ridge seen from there. Both faces must have an area.
struct HingeAngle {
  double angle = 0;
  Eigen::Matrix<double, 12, 1> gradient = Eigen::Matrix<double, 12, 1>::Zero();
  Eigen::Matrix<double, 12, 12> hessian = Eigen::Matrix<double, 12, 12>::Zero();
};
HingeAngle hinge_angle(const std::array<Eigen::Vector3d, 4>& corners, int order);

}  // namespace supple::embedded
