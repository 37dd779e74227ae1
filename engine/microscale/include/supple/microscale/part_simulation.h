#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/base/effect_switch.h"
#include "supple/base/execution.h"
#include "supple/microscale/material.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

// A part that is not periodic, under supports that move. Lengths in mm, forces in N, those of the whole thickness.

/// A side of the part's bounding box at rest.
enum class Side { bottom, top, left, right };
std::string_view to_string(Side side);

enum class Friction {
  none,  ///< points of the part slide along the plate
  stick  ///< a point that touches the plate moves along with it until it leaves the plate
};

/// A rigid plate with a straight surface along a side of the part. It pushes what touches it, and never pulls.
struct Plate {
  Side side = Side::bottom;
  double gap = 0;  ///< distance between the plate and the part at rest, >= 0
  Friction friction = Friction::none;
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< displacement at the end of the path
};

/// A clamp moves all points that lie in a box at rest, and holds their distances.
struct Clamp {
  Eigen::Vector2d lower = Eigen::Vector2d::Zero();  ///< corners of the box
  Eigen::Vector2d upper = Eigen::Vector2d::Zero();
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< displacement at the end of the path
};

using Support = std::variant<Plate, Clamp>;

struct PartSimulationOptions {
  Material material{};
  double thickness = 1;  ///< > 0
  /// The number of states. Supports have moved by the fraction k / states of their displacements in the k-th one.
  int states = 10;
  double tolerance = 1e-8;  ///< see SimulationOptions::tolerance
  int max_iterations = 60;  ///< Newton iterations for one load step before it is halved
  /// The largest motion of a support relative to another one in one internal load step, divided by the length of the
  /// part along this motion.
  double max_load_step = 0.05;
  Switch contact = Switch::automatic;   ///< see SimulationOptions::contact
  Switch buckling = Switch::automatic;  ///< see SimulationOptions::buckling
  double pressure_length = 1;           ///< length over which the pressure of a plate is averaged, > 0
  bool deformed_nodes = false;          ///< return each state's displacements of the nodes
};

/// Why a part's path ended.
enum class PartStop {
  converged,
  iteration_limit,  ///< the smallest load step did not converge
  step_too_small,   ///< no step decreased the energy, because a barrier or an element was at its limit
  lost_support      ///< the part touches too few supports to be held: it could move as a rigid body
};
std::string_view to_string(PartStop stop);

/// The pressure of a plate on the part, averaged over intervals of equal length.
struct PlatePressure {
  std::vector<double> positions;  ///< the middle of each interval along the plate, a coordinate of the part at rest
  std::vector<double> values;     ///< normal force over thickness and length of the interval, MPa
};

struct SupportState {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();         ///< the force that the support exerts on the part, N
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< mm
  int touching = 0;                                        ///< number of nodes that the support holds
  std::optional<PlatePressure> pressure;                   ///< that of a plate
};

struct PartState {
  double fraction = 0;  ///< fraction of the supports' displacements
  PartStop stopped = PartStop::converged;
  double residual = 0;  ///< |g| / f as in SimulationOptions::tolerance
  int iterations = 0;   ///< Newton iterations since the previous state
  int load_steps = 0;   ///< internal load steps since the previous state
  std::vector<SupportState> supports;
  double energy = 0;               ///< N mm, including contact
  bool stable = true;              ///< whether the stiffness of all points that no support holds is positive definite
  int branch = 0;                  ///< number of unstable branches that the path has left so far
  int contacts = 0;                ///< pairs of boundary points and sides within the contact barrier's range
  double largest_strain = 0;       ///< the largest |principal stretch - 1| at an integration point
  Eigen::Matrix2Xd displacements;  ///< those of the nodes, mm; empty unless they were asked for
};

struct PartSimulationResult {
  /// One state for each that was asked for. If the path ended early there are fewer, and the last one says why.
  std::vector<PartState> states;
  std::string message;  ///< why the path ended early; empty if it did not
  int nodes = 0;        ///< number of nodes of the mesh
  int unknowns = 0;     ///< number of unknowns of the largest system that was solved
  /// Whether one displacement is fixed because no support prevents the part from moving along its plates, which costs
  /// no energy.
  bool fixed_translation = false;
};

/// Follows the stable equilibria of a part while its supports move in proportion to their displacements. Beams touch
/// each other by the barrier of periodic simulations. Plates touch exactly: a node within a plate's surface is held
/// there while the plate pushes it, and is released otherwise.
///
/// `mesh` is one of `tiling::mesh_part`, or another one without a triangle across the border of its cell. `on_state` is
/// called with each state when it is known.
///
/// Throws "simulation.invalid_option", and "simulation.invalid_load", whose details name the support ("supports/1/box")
/// and the limit: no support, a number out of range, a box that holds fewer than two nodes, two clamps for one node,
/// two plates along one side, supports that run into each other, supports that leave a rigid motion. A path that cannot
/// be followed to its end is no error: the last state says why.
///
/// Bills the stages "assembly", "factorization", "solve" and "contact search", and the effects "contact" and
/// "buckling". Reports progress by the fraction.
PartSimulationResult simulate_part(const tiling::PeriodicMesh& mesh, const std::vector<Support>& supports,
                                   const PartSimulationOptions& options = {}, const Execution& execution = {},
                                   const std::function<void(const PartState&)>& on_state = {});

}  // namespace supple::microscale
