#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "supple/base/effect_switch.h"
#include "supple/base/execution.h"
#include "supple/embedded/host.h"
#include "supple/embedded/network.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

enum class RelaxationMethod { newton, lbfgs, gradient_descent };

/// What a spring's length is: of the shortest path on the surface, or of the straight segment through space, which is
/// cheaper and lets networks stick at edges (thesis fig. 3.12).
enum class SpringLength { geodesic, euclidean };

/// One state on the way: the start or the one after an iteration.
struct RelaxationStep {
  double energy = 0;  ///< unit of the weights times squared mesh units
  /// |grad E| by tangent coordinates of the free points; the least of all convex combinations where a path is kept at
  /// its cut locus
  double gradient_norm = 0;
  double step_length = 0;     ///< root of the sum of the points' squared ways to reach this state; 0 for the start
  double regularization = 0;  ///< added to the Hessian's diagonal for that step
};

struct RelaxationOptions {
  /// What carries the network. On a shell or a solid its nodes are unknowns besides the points (thesis eq. 3.22). On
  /// all but rigid ones springs are geodesic, and there is no mollifier.
  Host host = RigidHost{};
  RelaxationMethod method = RelaxationMethod::newton;
  SpringLength spring_length = SpringLength::geodesic;
  /// Converged once |grad E| <= tolerance * (largest weight) * (mesh diagonal).
  double tolerance = 1e-9;
  int max_iterations = 200;
  /// Smoothing of paths next to vertices (thesis eq. 3.12): on; off; or automatic: only where the search without it
  /// does not converge and a path passes through a vertex, from where that search ended.
  Switch mollifier = Switch::automatic;
  /// The mollifier's length as a fraction of an edge, in (0, 0.5].
  double mollifier_length = 1e-6;
  /// Whether the faces that a spring crossed in the state before are unfolded first, and searched for a shorter path
  /// only where that cannot be excluded. Never changes the answer. automatic: on.
  Switch kept_strips = Switch::automatic;
  /// Called with the start and the state after every iteration, on the thread of the caller, with the surface as it is
  /// then.
  std::function<void(const RelaxationStep& step, std::span<const surface::SurfacePoint> points,
                     const surface::TriangleMesh& surface)>
      observer{};
  /// Whether the paths of the springs are wanted in the answer.
  bool paths = false;
};

/// What is known of a spring at the end.
struct SpringState {
  double length = 0;  ///< mesh units
  double energy = 0;
  bool compressed = false;  ///< shorter than its rest length: its energy pushes towards longer paths
  /// Another path is as short (within 1e-9, relative): the length has a kink there, a ridge for a spring under tension
  /// and a valley for one under compression, in which its ends can rest.
  bool at_cut_locus = false;
  std::vector<surface::PathPoint> path{};  ///< from `from` to `to`; empty unless asked for
};

/// What is known of a triangle at the end.
struct TriangleState {
  double energy = 0;
  std::array<double, 2> stretches{};  ///< principal stretches, the greater first
  /// A side that pushes is where another path is as short (within 1e-9, relative): see SpringState::at_cut_locus.
  bool at_cut_locus = false;
};

/// How the network followed a moving surface or moved vertices to one of their positions.
struct FollowedStop {
  double energy = 0;
  double gradient_norm = 0;
  int iterations = 0;
  int load_steps = 0;  ///< parts that the way to here was divided into
  /// How often an equilibrium was lost on the way, so that network and host went to another one of less energy: on the
  /// way back they need not return to where they were.
  int jumps = 0;
  std::string stopped;  ///< as Relaxation::stopped
  /// Share of the way from the position before; below 1 where moved vertices cannot go on, since tetrahedra or faces
  /// would be turned inside out: it is then the last stop.
  double reached = 1;
};

/// A host that gave way or moved.
struct HostState {
  struct Term {
    std::string name;  ///< "shell_membrane", "shell_bending", "shell_volume", "solid" or "gravity"
    double energy = 0;
  };
  std::vector<Term> terms;
  std::vector<Eigen::Vector3d> vertices;                ///< where the surface's vertices are
  std::vector<Eigen::Vector3d> inside;                  ///< where the other nodes of a solid are
  std::vector<std::array<std::int32_t, 4>> tetrahedra;  ///< of a solid: nodes, the surface's vertices first
  double largest_displacement = 0;                      ///< of a node, mesh units
  double volume_ratio = 0;  ///< the volume that a closed surface encloses over that at rest; 0 for an open one
};

struct Relaxation {
  std::vector<surface::SurfacePoint> points;
  std::vector<SpringState> springs;
  std::vector<TriangleState> triangles{};
  double energy = 0;                  ///< of all
  double network_energy = 0;          ///< of springs and triangles
  HostState host{};                   ///< empty on a rigid host
  std::vector<FollowedStop> stops{};  ///< of a moving host and of moved vertices: one for each position
  double gradient_norm = 0;
  double gradient_tolerance = 0;  ///< what the norm is compared with
  int iterations = 0;
  std::vector<RelaxationStep> history;  ///< the start and every iteration
  /// "converged", also where springs or sides that push rest at their cut loci, each of the shortest paths with its
  /// share of the force; "cut_locus" (no step lowers the energy although a gradient is left, and what pushes is at its
  /// cut locus, where its length is not differentiable; neither do moves of the other points with the ends of such
  /// paths held, nor of these ends singly, in pairs and together); "step_too_small"; or "iteration_limit".
  std::string stopped;
  bool mollified = false;  ///< whether the energy at the end is the mollified one
  /// Points that came to rest exactly at a vertex where the energy has a kink and no direction descends, ascending.
  std::vector<std::int32_t> at_vertices;
  /// Free points that no spring of positive weight holds: they stay where they are. Ascending.
  std::vector<std::int32_t> loose_points;
  /// What deserves attention, one sentence each: springs under compression, loose points, springs at cut loci.
  std::vector<std::string> warnings;
};

/// Moves the free points of a network to a local minimum of its energy on a rigid surface: E = the sum of weight
/// (length
/// - rest_length)^2 over the springs (thesis eq. 3.13) and of the neo-Hookean energies of the triangles (eq. 3.17 to
/// 3.20; thickness times area at rest times energy density). E never rises on the way.
///
/// Newton's method with exact Hessians (thesis eq. 3.7 to 3.11): one distance with derivatives for each spring and
/// state, in parallel, and one sparse factorization. lbfgs and gradient_descent use the same evaluations. Bills the
/// effects "geodesic_springs" or "euclidean_springs", "membrane" where there are triangles, "mollifier" and
/// "kept_strips", the stages "search", "assembly", "step", and the quantities "same_face", "unfolded" and "searched"
/// (springs by how their path was found).
///
/// On a host that gives way, the host's energy counts too, and points and nodes move together (eq. 3.21 and 3.22): a
/// step then costs a search for each path, O(m^2) for the derivatives by the vertices along a path of m faces, and the
/// factorization of a matrix of all unknowns. Parts of the host that nothing holds stay where they are as a whole. A
/// host does not notice where it touches itself, which the effect "self_contact" says. Bills "shell_membrane",
/// "shell_bending", "shell_volume", "solid" and "gravity", and the stages "tetrahedra" and "host_derivatives".
///
/// Vertices of a host that are moved stay where they are until network and host are at rest. Then they are taken to
/// their positions, and points and nodes follow them in the same way (numerics::EquilibriumPath), from stable
/// equilibrium to stable equilibrium. Where they cannot go on since elements would be turned inside out, the last
/// equilibrium is the answer. Bills the effect "moved_vertices".
///
/// A network on a moving surface comes to rest on the mesh first and then follows the surface from position to
/// position: the surface carries the points along, then they take a step along the tangent to the path of equilibria
/// where that lowers E, and come to rest. A step on which an equilibrium is lost, so that the way back would lead
/// elsewhere, is halved; where even the shortest loses it, the one that is found counts in `stops`. Motions that keep
/// all lengths do no work.
///
/// Throws what checked_network throws, "network.invalid_option" (tolerance, max_iterations, mollifier_length, triangles
/// with straight springs, a mollifier or straight springs on a host that gives way), "network.collapsed" where a
/// triangle has no area at the start, which has no energy, and of the host "host.invalid", "host.fixed_vertex",
/// "host.moved_vertex", "host.open_surface", "host.unsupported", "host.positions" (of a moving one: not as many as
/// vertices, or faces without area), and what meshing::fill throws.
Relaxation relax(const surface::GeodesicSolver& solver, const Network& network, const RelaxationOptions& options = {},
                 const Execution& execution = {});

}  // namespace supple::embedded
