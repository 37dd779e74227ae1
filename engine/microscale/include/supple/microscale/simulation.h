#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "supple/base/effect_switch.h"
#include "supple/base/execution.h"
#include "supple/microscale/material.h"
#include "supple/tiling/mesh.h"
#include "supple/tiling/structure.h"

namespace supple::microscale {

// Macroscopic loads. A list of strains or stretches is one path from rest, which is followed in its order. A stretch is
// a length divided by the length at rest, > 0.

/// This load imposes the Green strain (E_xx, E_yy, E_xy; tensor components) exactly. The macroscopic rotation is the
/// identity.
struct GreenStrainLoad {
  std::vector<Eigen::Vector3d> strains;
};
/// The frame in which the direction of a uniaxial load is fixed.
enum class LoadFrame {
  space,     ///< F^T d = s d, as in the simulations of [Thesis, eq. 4.2]: the stress is uniaxial along F^-1 d
  material,  ///< F d = s d, as in inverse design [Thesis, eq. 4.9]: the stress is uniaxial along d
};
/// This load imposes the stretch s along the direction d = (cos, sin). The rest of F is free: lateral strain and shear
/// have the least energy.
struct UniaxialLoad {
  double direction = 0;  ///< rad
  std::vector<double> stretches;
  LoadFrame frame = LoadFrame::space;
};
/// This load imposes F = s d d^T + s0 n n^T, where n is orthogonal to d.
struct BiaxialLoad {
  double direction = 0;                    ///< rad
  std::vector<Eigen::Vector2d> stretches;  ///< (s, s0)
};
using Load = std::variant<GreenStrainLoad, UniaxialLoad, BiaxialLoad>;

/// The number of states on a load's path.
int size(const Load& load);

using supple::Switch;

/// Whether states are also found on a finer mesh, on which every triangle is divided in four.
enum class Refinement {
  off,           ///< states are those of the mesh, and its error is not estimated
  estimated,     ///< states are those of the mesh, and their error is estimated from the finer one
  extrapolated,  ///< states are extrapolated from both meshes; the small remaining error is estimated
};

struct SimulationOptions {
  Material material{};
  /// Size and grading of the mesh; see tiling::MeshOptions. The default is the mesh of the data sets.
  tiling::MeshOptions mesh{};
  /// A state is an equilibrium if |g| <= tolerance * f. Here g is the gradient of the energy with respect to the nodes
  /// and the free strain components, and f is the root of the sum over triangles of |nodal forces of the triangle|^2
  /// (MPa mm per mm of thickness).
  double tolerance = 1e-8;
  int max_iterations = 60;  ///< Newton iterations for one load step before it is halved
  /// The largest change of any component of F in one internal load step. Longer steps are divided.
  double max_load_step = 0.05;
  /// Self-contact. automatic and on search for it in every step, and evaluate it while a pair of boundary points is
  /// within the barrier's range (the energy of all other pairs is exactly zero). off lets beams pass through each
  /// other.
  Switch contact = Switch::automatic;
  /// 2x2 cells. automatic simulates one cell until one of its equilibria is unstable against a mode that alternates
  /// from cell to cell (the three other Bloch phases of the 2x2 patch), and then two by two cells. on uses them from
  /// the start, and off never does.
  Switch patch = Switch::automatic;
  /// A step along the least stable mode, which is taken if the tangent is not positive definite. automatic means on.
  /// off reports the unstable state.
  Switch buckling = Switch::automatic;
  /// A refinement takes about as much time as the states themselves. off suits data sets, in which all designs have the
  /// error of one mesh, and studies that compare several meshes themselves.
  Refinement refinement = Refinement::off;
  bool tangents = true;          ///< compute the tangent stiffness of each state
  bool deformed_meshes = false;  ///< return each state's node positions
};

/// Why the search for an equilibrium ended.
enum class Stop {
  converged,
  iteration_limit,  ///< the smallest load step did not converge
  step_too_small,   ///< no step decreased the energy, because a barrier or an element was at its limit
};
std::string_view to_string(Stop stop);

/// The discretization error of a mesh. It has the units of the quantities, or is relative to them.
struct MeshError {
  double stress = 0;          ///< Frobenius norm of the error
  double energy_density = 0;  ///< absolute value of the error
};

struct DeformedMesh {
  std::shared_ptr<const tiling::PeriodicMesh> mesh;  ///< rest state
  Eigen::Matrix2d lattice;                           ///< deformed translations of the patch, mm
  Eigen::Matrix2Xd nodes;                            ///< deformed positions, mm
};

/// One equilibrium. Everything is per area of the whole cell at rest, including its holes.
struct State {
  Eigen::Vector3d green_strain = Eigen::Vector3d::Zero();  ///< E_xx, E_yy, E_xy
  Eigen::Vector3d stress = Eigen::Vector3d::Zero();        ///< second Piola-Kirchhoff S_xx, S_yy, S_xy, MPa
  double energy_density = 0;                               ///< MPa, including contact
  /// d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy), MPa, symmetric. NaN if it is singular or was not requested.
  Eigen::Matrix3d tangent = Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
  Stop stopped = Stop::converged;
  double residual = 0;  ///< |g| / f as in SimulationOptions::tolerance
  int iterations = 0;   ///< Newton iterations since the previous state
  int load_steps = 0;   ///< internal load steps since the previous state
  /// The number of pairs of boundary points and sides within the barrier's range. The range was reduced until no pair
  /// was within it or until it no longer influenced the state.
  int contacts = 0;
  /// The smallest gap between sides that are not neighbours, mm; infinity if no gap was searched or none is near.
  double smallest_gap = std::numeric_limits<double>::infinity();
  /// Whether the stiffness is positive definite for all modes of the patch, including modes of two by two cells if
  /// those were checked.
  bool stable = true;
  int branch = 0;                ///< number of unstable branches that the path has left so far
  int cells = 1;                 ///< cells along each side of the patch: 1 or 2
  double smallest_jacobian = 1;  ///< least det F over the whole area of all elements
  /// The estimated error of the mesh, MPa. The error of at least nine of ten states is less than it, see
  /// docs/bench/simulations.md. There is none in the following cases: `SimulationOptions::refinement` is
  /// off; the state did not converge or is not stable; there is no stable equilibrium near it on the finer mesh; that
  /// mesh would have more nodes than MeshOptions::max_nodes.
  std::optional<MeshError> mesh_error;
  std::optional<DeformedMesh> deformed;
};

struct SimulationResult {
  /// One state for each state of the load. If the path ended early there are fewer, and the last one says why.
  std::vector<State> states;
  std::string message;  ///< why the path ended early; empty if it did not
  int nodes = 0;        ///< number of nodes of one cell's mesh
  int unknowns = 0;     ///< number of unknowns of the largest system that was solved
  /// Whether states are extrapolated if possible. False also if the finer mesh would have more nodes than
  /// MeshOptions::max_nodes.
  bool extrapolated = false;
};

/// The relative error of the stress and of the energy density of a path, dimensionless: the root mean square of the
/// estimated errors of all converged states, divided by that of the quantity. 0 if the quantity is zero in all of them,
/// as at rest. None if one of these states has no estimate.
std::optional<MeshError> discretization_error(const std::vector<State>& states);

/// A meshed structure that can be loaded. Its factorization patterns are reused from load to load. Threads must not
/// share a simulator.
class Simulator {
 public:
  /// Meshes one cell. Throws what tiling::mesh_structure throws, and "simulation.invalid_option", which names the
  /// option and its limits.
  Simulator(const tiling::Structure& structure, const SimulationOptions& options, const Execution& execution = {});
  /// Takes a mesh that exists already, for example that of a solid cell.
  Simulator(tiling::PeriodicMesh one_cell, const SimulationOptions& options, const Execution& execution = {});
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  /// Follows the load's path from rest. Throws "simulation.invalid_load", which names the state, if a stretch or strain
  /// is out of range; F must have det > 0. A path that cannot be followed to its end is no error: the last state says
  /// why.
  /// Bills the stages "assembly", "factorization", "solve", "contact search" and "patch stability", and the effect
  /// "refinement" with its time; reports progress by states.
  SimulationResult run(const Load& load, const Execution& execution = {});

  const tiling::PeriodicMesh& mesh() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Meshes a structure and loads it once, with a Simulator of its own. Throws what Simulator and Simulator::run throw.
SimulationResult simulate(const tiling::Structure& structure, const Load& load, const SimulationOptions& options = {},
                          const Execution& execution = {});

}  // namespace supple::microscale
