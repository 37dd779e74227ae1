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

/// Macroscopic loads; a list is one path from rest, followed in its order. Stretches are lengths over rest lengths, >
/// 0.
///
/// The Green strain (E_xx, E_yy, E_xy; tensor components) imposed exactly; the macroscopic rotation is the identity.
struct GreenStrainLoad {
  std::vector<Eigen::Vector3d> strains;
};
/// What the direction of a uniaxial load is a direction of.
enum class LoadFrame {
  space,     ///< F^T d = s d, as in the thesis's simulations: the stress is uniaxial along F^-1 d of the material
  material,  ///< F d = s d, as in inverse design (thesis 4.9): the stress is uniaxial along d
};
/// Stretch s along the direction d = (cos, sin), the rest of F free (lateral strain and shear at least energy).
struct UniaxialLoad {
  double direction = 0;  ///< rad
  std::vector<double> stretches;
  LoadFrame frame = LoadFrame::space;
};
/// F = s d d^T + s0 n n^T, n orthogonal to d.
struct BiaxialLoad {
  double direction = 0;                    ///< rad
  std::vector<Eigen::Vector2d> stretches;  ///< (s, s0)
};
using Load = std::variant<GreenStrainLoad, UniaxialLoad, BiaxialLoad>;

/// Number of states of a load's path.
int size(const Load& load);

using supple::Switch;

struct SimulationOptions {
  Material material{};
  /// Side length over beam width and grading; see tiling::MeshOptions. The default is the mesh of the data sets.
  tiling::MeshOptions mesh{};
  /// A state is an equilibrium once |g| <= tolerance * f: g the energy's gradient with respect to the nodes and free
  /// strain components, f the sum in squares of what the single terms add to it (MPa mm per mm of thickness).
  double tolerance = 1e-8;
  int max_iterations = 60;  ///< Newton iterations for one load step before it is halved
  /// Largest change of any component of F in one internal load step; longer ones are divided.
  double max_load_step = 0.05;
  /// Self-contact. automatic and on: looked for in every step, assembled while a pair of boundary points is within the
  /// barrier's range (the energy of the others is exactly zero). off: beams pass through each other.
  Switch contact = Switch::automatic;
  /// 2x2 cells. automatic: one cell until an equilibrium of it is unstable against a mode that alternates from cell to
  /// cell (the three other Bloch phases of the 2x2 patch), then two by two. on: from the start. off: never.
  Switch patch = Switch::automatic;
  /// A deliberate step along the least stable mode where the tangent is not positive definite. automatic is on; off
  /// reports the unstable state.
  Switch buckling = Switch::automatic;
  bool tangents = true;          ///< compute the tangent stiffness of each state
  bool deformed_meshes = false;  ///< keep each state's node positions
};

enum class Stop {
  converged,
  iteration_limit,  ///< the smallest load step did not converge
  step_too_small,   ///< no descent was found: barrier or element at its limit
};
std::string_view to_string(Stop stop);

struct DeformedMesh {
  std::shared_ptr<const tiling::PeriodicMesh> mesh;  ///< rest state
  Eigen::Matrix2d lattice;                           ///< deformed translations of the patch, mm
  Eigen::Matrix2Xd nodes;                            ///< deformed positions, mm
};

/// One equilibrium. Everything is per rest area of the whole cell, holes included.
struct State {
  Eigen::Vector3d green_strain = Eigen::Vector3d::Zero();  ///< E_xx, E_yy, E_xy
  Eigen::Vector3d stress = Eigen::Vector3d::Zero();        ///< second Piola-Kirchhoff S_xx, S_yy, S_xy, MPa
  double energy_density = 0;                               ///< MPa, contact included
  /// d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy), MPa, symmetric. NaN where it was not asked for or is singular.
  Eigen::Matrix3d tangent = Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
  Stop stopped = Stop::converged;
  double residual = 0;  ///< |g| / f as in SimulationOptions::tolerance
  int iterations = 0;   ///< Newton iterations since the previous state
  int load_steps = 0;   ///< internal load steps since the previous state
  /// Pairs of boundary points and sides within the barrier's range, which was made less until they touch or it no
  /// longer matters.
  int contacts = 0;
  /// mm, between sides that are not neighbours; infinity where none was looked for
  double smallest_gap = std::numeric_limits<double>::infinity();
  bool stable = true;  ///< positive definite against all modes of the patch, two-by-two ones included if looked for
  int branch = 0;      ///< how many times the path has left an unstable branch
  int cells = 1;       ///< cells along each side of the patch: 1 or 2
  double smallest_jacobian = 1;  ///< least det F over all elements, their whole area
  std::optional<DeformedMesh> deformed;
};

struct SimulationResult {
  std::vector<State> states;  ///< one per state of the load, unless it stopped early: then the last has stopped
  std::string message;        ///< why it stopped early; empty if it did not
  int nodes = 0;              ///< of one cell's mesh
  int unknowns = 0;           ///< of the largest system solved
};

/// A meshed structure ready for loads; keeps factorization patterns and the rest stiffness. Not shared between threads.
class Simulator {
 public:
  /// Meshes one cell. Throws what tiling::mesh_structure throws and "simulation.invalid_option" (named, with limits).
  Simulator(const tiling::Structure& structure, const SimulationOptions& options, const Execution& execution = {});
  /// For a mesh at hand, e.g. a solid cell.
  Simulator(tiling::PeriodicMesh one_cell, const SimulationOptions& options, const Execution& execution = {});
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  /// Follows the load's path from rest. Throws "simulation.invalid_load" (a stretch or strain out of range, a state
  /// named; F must have det > 0). A path that cannot be followed to its end is no error: the last state says why.
  /// Bills the stages "assembly", "factorization", "solve", "contact search" and "patch stability"; reports progress by
  /// states.
  SimulationResult run(const Load& load, const Execution& execution = {});

  const tiling::PeriodicMesh& mesh() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::microscale
