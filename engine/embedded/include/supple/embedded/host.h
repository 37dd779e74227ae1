#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <variant>
#include <vector>

namespace supple::embedded {

/// A surface that keeps its shape.
struct RigidHost {};

/// A vertex that is held, and is taken elsewhere once network and host are at rest.
struct MovedVertex {
  std::int32_t vertex = 0;
  /// One after the other, each reached on a straight way from the one before, the first from the mesh. At least one;
  /// where other vertices have more, it stays at its last.
  std::vector<Eigen::Vector3d> positions{};
};

/// The surface is a thin elastic shell, at rest where the mesh has it: each face a constant-strain triangle of a
/// compressible neo-Hookean sheet under plane stress, each inner edge a hinge (Grinspun, Hirani, Desbrun and Schroeder
/// 2003, "Discrete shells"). An enclosed volume may be kept, or be blown up: E = volume_weight / 2 (V - volume_scale
/// V0)^2 / V0.
struct ShellHost {
  double thickness = 0.003;                    ///< mesh units, positive
  double youngs_modulus = 1e4;                 ///< energy per cubed mesh unit, positive
  double poisson_ratio = 0.48;                 ///< in (-1, 0.5)
  double volume_weight = 0;                    ///< a pressure, energy per cubed mesh unit; 0 leaves the volume free
  double volume_scale = 1;                     ///< of the volume at rest, positive
  bool bending = true;                         ///< whether hinges resist
  std::vector<std::int32_t> fixed_vertices{};  ///< stay where they are, in any order
  std::vector<MovedVertex> moved_vertices{};   ///< none of them fixed, each once
};

/// An axis-aligned box of another stiffness.
struct SolidRegion {
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();  ///< mesh units
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
  double youngs_modulus = 1;  ///< energy per cubed mesh unit, positive
};

/// The closed surface is filled with linear tetrahedra of a compressible neo-Hookean solid with the logarithm of the
/// volume (Bonet and Wood 2008, eq. 6.27): psi = mu / 2 (tr C - 3) - mu log J + lambda / 2 log(J)^2.
struct SolidHost {
  double youngs_modulus = 10;                         ///< energy per cubed mesh unit, positive
  double poisson_ratio = 0.49;                        ///< in (-1, 0.5)
  double element_size = 0;                            ///< of tetrahedra inside, mesh units; 0: the mean edge
  std::vector<SolidRegion> regions{};                 ///< by a tetrahedron's centre; of several the last counts
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< force per volume at rest, energy per mesh unit^4
  std::vector<std::int32_t> fixed_vertices{};         ///< of the surface; stay where they are, in any order
  std::vector<MovedVertex> moved_vertices{};          ///< of the surface; none of them fixed, each once
};

/// The surface moves along given positions of its vertices and takes no notice of the network, which follows from one
/// equilibrium to the next.
struct MovingHost {
  /// Of all vertices, one set after the other, each reached on straight ways from the one before; the first from the
  /// mesh as it is. At least one.
  std::vector<std::vector<Eigen::Vector3d>> positions;
};

/// What carries a network.
using Host = std::variant<RigidHost, ShellHost, SolidHost, MovingHost>;

}  // namespace supple::embedded
