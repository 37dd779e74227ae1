#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <variant>
#include <vector>

namespace supple::embedded {

/// A surface that neither deforms nor moves.
struct RigidHost {};

/// A vertex with prescribed positions. It is fixed where the mesh has it until network and host are in equilibrium, and
/// moves then.
struct MovedVertex {
  std::int32_t vertex = 0;
  /// Positions that it reaches one after the other, on straight segments that begin at its position in the mesh. At
  /// least one. While other vertices have further positions, it stays at its last.
  std::vector<Eigen::Vector3d> positions{};
};

/// A thin elastic shell, which is at rest in the shape of the mesh. Each face is a constant-strain triangle of a
/// compressible neo-Hookean sheet under plane stress, each inner edge a hinge [Grinspun2003]. An energy can keep the
/// enclosed volume V or inflate it from V0 at rest: E = volume_weight / 2 (V - volume_scale V0)^2 / V0.
struct ShellHost {
  double thickness = 0.003;                    ///< mesh units, positive
  double youngs_modulus = 1e4;                 ///< energy per cubed mesh unit, positive
  double poisson_ratio = 0.48;                 ///< in (-1, 0.5)
  double volume_weight = 0;                    ///< a pressure, energy per cubed mesh unit; 0 leaves the volume free
  double volume_scale = 1;                     ///< the volume aimed at, as a ratio to that at rest; positive
  bool bending = true;                         ///< whether hinges have an energy
  std::vector<std::int32_t> fixed_vertices{};  ///< in any order
  std::vector<MovedVertex> moved_vertices{};   ///< each once, and none of them fixed
};

/// An axis-aligned box with a Young's modulus of its own.
struct SolidRegion {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< mesh units
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
  double youngs_modulus = 1;  ///< energy per cubed mesh unit, positive
};

/// An elastic solid: linear tetrahedra fill the closed surface. The material is compressible neo-Hookean [Bonet2008,
/// eq. 6.27]: psi = mu / 2 (tr C - 3) - mu log J + lambda / 2 log(J)^2.
struct SolidHost {
  double youngs_modulus = 10;                         ///< energy per cubed mesh unit, positive
  double poisson_ratio = 0.49;                        ///< in (-1, 0.5)
  double element_size = 0;                            ///< edge length of inner tetrahedra, mesh units; 0: the mean edge
  std::vector<SolidRegion> regions{};                 ///< the last one that contains a tetrahedron's centre applies
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< force per volume at rest, energy per mesh unit^4
  std::vector<std::int32_t> fixed_vertices{};         ///< vertices of the surface, in any order
  std::vector<MovedVertex> moved_vertices{};          ///< vertices of the surface, each once, and none of them fixed
};

/// A surface that moves through given positions of its vertices. The network does not act on it; it follows from one
/// equilibrium to the next.
struct MovingHost {
  /// Sets of positions of all vertices, at least one. They are reached one after the other on straight segments that
  /// begin at the mesh.
  std::vector<std::vector<Eigen::Vector3d>> positions;
};

/// The surface on which a network lies, and how it responds.
using Host = std::variant<RigidHost, ShellHost, SolidHost, MovingHost>;

}  // namespace supple::embedded
