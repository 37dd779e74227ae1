#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/effect_switch.h"
#include "supple/base/execution.h"
#include "supple/embedded/host.h"
#include "supple/embedded/network.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

enum class RelaxationMethod { newton, lbfgs, gradient_descent };

/// A spring's length is that of the shortest path on the surface, or that of the straight segment through space. The
/// segment is cheaper, but networks can get stuck at edges of the mesh [Thesis, fig. 3.12].
enum class SpringLength { geodesic, euclidean };

/// The state at the start or after an iteration.
struct RelaxationStep {
  double energy = 0;  ///< unit of the weights times squared mesh units
  /// |grad E| by tangent coordinates of the free points. If a path under compression stays at its cut locus, E has
  /// several gradients there, and this is the least norm of their convex combinations. While a jam is left, points that
  /// are fixed meanwhile do not count.
  double gradient_norm = 0;
  double step_length = 0;     ///< norm of the points' displacements from the state before, mesh units; 0 at the start
  double regularization = 0;  ///< added to the Hessian's diagonal for that step
};

struct RelaxationOptions {
  /// The surface under the network. The nodes of a shell or a solid are unknowns besides the points [Thesis, eq. 3.22].
  /// Only a rigid host permits Euclidean spring lengths and the mollifier.
  Host host = RigidHost{};
  RelaxationMethod method = RelaxationMethod::newton;
  SpringLength spring_length = SpringLength::geodesic;
  /// The search has converged if |grad E| <= tolerance * largest_weight(network) * (diagonal of the mesh's bounding
  /// box).
  double tolerance = 1e-9;
  int max_iterations = 200;
  /// Smoothing of path lengths next to vertices [Thesis, eq. 3.12]. `automatic` first searches without it. Only if that
  /// does not converge and a path passes through a vertex, it goes on with the mollifier from where the search ended.
  Switch mollifier = Switch::automatic;
  /// The mollifier's length as a fraction of each edge that a path crosses, in (0, 0.5].
  double mollifier_length = 1e-6;
  /// Whether the strip of faces that a spring crossed in the state before is unfolded first. A search for the shortest
  /// path follows only if a shorter one cannot be excluded. Never changes the answer. automatic: on.
  Switch kept_strips = Switch::automatic;
  /// Called with the state at the start and after every iteration, and with the surface in that state, on the caller's
  /// thread.
  std::function<void(const RelaxationStep& step, std::span<const surface::SurfacePoint> points,
                     const surface::TriangleMesh& surface)>
      observer{};
  /// Whether the answer has the paths of the springs.
  bool paths = false;
};

/// State of a spring at the end.
struct SpringState {
  double length = 0;  ///< mesh units
  double energy = 0;
  bool compressed = false;  ///< shorter than its rest length: its energy pushes towards longer paths
  /// Whether another path is as short, within a relative 1e-9. The energy has a kink there: a ridge under tension, and
  /// under compression a valley, in which the spring's ends can be in equilibrium.
  bool at_cut_locus = false;
  std::vector<surface::PathPoint> path{};  ///< from `from` to `to`; empty unless RelaxationOptions::paths is set
};

/// State of a triangle at the end.
struct TriangleState {
  double energy = 0;
  std::array<double, 2> stretches{};  ///< principal stretches, the greater first
  /// Whether a side under compression has another path as short, within a relative 1e-9: see SpringState::at_cut_locus.
  bool at_cut_locus = false;
};

/// Why a search for an equilibrium ended.
enum class RelaxationTermination {
  /// The gradient is within its tolerance. Springs or sides under compression may be at their cut loci, where the force
  /// on an end is a convex combination over the shortest paths.
  converged,
  /// A gradient is left, but no step lowers the energy, since a path under compression is at its cut locus, where its
  /// length is not differentiable. Steps of the other points with the ends of such paths fixed were tried too, and
  /// steps of these ends singly, in pairs and together.
  cut_locus,
  step_too_small,
  iteration_limit,
  deadline,  ///< the deadline passed; the result is the last state of the history
  memory     ///< a limit of memory was reached; the result is the last state of the history
};
/// "converged", "cut_locus", "step_too_small", "iteration_limit", "deadline" or "memory".
std::string_view to_string(RelaxationTermination termination);

/// One load increment: how the network followed a moving surface or moved vertices to one of their positions.
struct LoadIncrement {
  double energy = 0;
  double gradient_norm = 0;
  int iterations = 0;
  int load_steps = 0;  ///< steps into which the increment was divided
  /// How often the increment lost its equilibrium path, so that network and host went to another equilibrium of less
  /// energy. Under the reverse motion they need not return to where they were.
  int jumps = 0;
  RelaxationTermination stopped = RelaxationTermination::converged;
  /// Fraction of the increment. It is below 1 if moved vertices cannot go on, because tetrahedra or faces would be
  /// inverted; this is then the last increment.
  double reached = 1;
};

/// State of a host that deformed or moved.
struct HostState {
  struct Term {
    std::string name;  ///< "shell_membrane", "shell_bending", "shell_volume", "solid" or "gravity"
    double energy = 0;
  };
  std::vector<Term> terms;
  std::vector<Eigen::Vector3d> vertices;                ///< positions of the surface's vertices
  std::vector<Eigen::Vector3d> inside;                  ///< positions of a solid's other nodes
  std::vector<std::array<std::int32_t, 4>> tetrahedra;  ///< indices into `vertices` followed by `inside`
  double largest_displacement = 0;                      ///< maximum over all nodes, mesh units
  double volume_ratio = 0;  ///< ratio of the volume in a closed surface to that at rest; 0 for an open surface
};

struct Relaxation {
  std::vector<surface::SurfacePoint> points;
  std::vector<SpringState> springs;
  std::vector<TriangleState> triangles{};
  double energy = 0;                   ///< energy of network and host together
  double network_energy = 0;           ///< energy of springs and triangles
  HostState host{};                    ///< empty on a rigid host
  std::vector<LoadIncrement> stops{};  ///< one for each position of a moving host or of moved vertices that was reached
  double gradient_norm = 0;
  double gradient_tolerance = 0;  ///< the norm up to which the search has converged
  int iterations = 0;
  std::vector<RelaxationStep> history;  ///< the start and every iteration
  RelaxationTermination stopped = RelaxationTermination::converged;
  bool mollified = false;  ///< whether the energy at the end is the mollified one
  /// Points, ascending, that ended exactly at a vertex at which the energy has a kink and no descent direction.
  std::vector<std::int32_t> at_vertices;
  /// Free points, ascending, without a spring of positive weight or a triangle. They do not move.
  std::vector<std::int32_t> loose_points;
  /// One sentence for each fact that deserves attention: springs under compression, loose points, springs at cut loci.
  std::vector<std::string> warnings;
};

/// Moves the free points of a network on a rigid surface to a local minimum of its energy E: the sum of weight
/// (length - rest_length)^2 over the springs [Thesis, eq. 3.13] and of the neo-Hookean energies of the triangles
/// [Thesis, eq. 3.17 to 3.20], which are thickness times area at rest times energy density. No iteration increases E.
///
/// Newton's method uses exact Hessians [Thesis, eq. 3.7 to 3.11]: each state costs a distance with derivatives for each
/// spring, in parallel, and a sparse factorization. lbfgs and gradient_descent use the same evaluations. Bills the
/// effects "geodesic_springs" or "euclidean_springs", "membrane" if there are triangles, "mollifier" and "kept_strips",
/// the stages "search", "assembly" and "step", and the quantities "same_face", "unfolded" and "searched" (springs by
/// how their path was found).
///
/// On a deformable host, E includes the host's energy, and points and nodes move together [Thesis, eq. 3.21 and 3.22].
/// A step then costs a search for each path, O(m^2) for the derivatives by the vertices along a path of m faces, and
/// the factorization of a matrix of all unknowns. Rigid-body constraints keep a part of the host from moving as a whole
/// if no fixed vertices do. Contact of the host with itself is neglected, which the effect "self_contact" says. Bills
/// "shell_membrane", "shell_bending", "shell_volume", "solid" and "gravity", and the stages "tetrahedra" and
/// "host_derivatives".
///
/// Moved vertices of a host are fixed until network and host are in equilibrium. Then they move to their positions, and
/// points and nodes follow a path of stable equilibria (numerics::EquilibriumPath). If they cannot go on because
/// elements would be inverted, the last equilibrium is the answer. Bills the effect "moved_vertices".
///
/// A network on a moving surface first reaches equilibrium on the mesh and then follows the surface from position to
/// position. In each step the surface carries the points along, then they take a step along the tangent to the
/// equilibrium path if that lowers E, and then E is minimized. A step that loses the equilibrium, so that the reverse
/// motion would lead elsewhere, is halved; if even the shortest step loses it, `stops` counts a jump. Motions that
/// preserve all lengths do no work.
///
/// If a stop is requested for a deadline or a limit of memory (StopReason), or memory is refused, after the first state
/// was evaluated, the result is the best state so far, which is the last one of the history. A warning says so. The
/// stop is taken back for the report. Once a host moves, or its vertices are moved, the result is the equilibrium at
/// the last position that was reached, and `stops` ends there; before the first one it is the equilibrium at rest.
///
/// Throws what checked_network throws; "network.invalid_option" (tolerance, max_iterations, mollifier_length, triangles
/// with Euclidean springs, a mollifier or Euclidean springs on a host that deforms or moves); "network.collapsed" if a
/// triangle has no area at the start, where its energy is not defined; for the host "host.invalid",
/// "host.fixed_vertex", "host.moved_vertex", "host.open_surface", "host.unsupported" and "host.positions" (a moving
/// host's positions are not as many as the vertices, or give faces without area); and what meshing::fill throws.
Relaxation relax(const surface::GeodesicSolver& solver, const Network& network, const RelaxationOptions& options = {},
                 const Execution& execution = {});

}  // namespace supple::embedded
