#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "element_energies.h"
#include "host_element.h"
#include "network_state.h"
#include "supple/base/effect_switch.h"
#include "supple/embedded/network.h"
#include "supple/numerics/system.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/surface/vertex_cone.h"

namespace supple::embedded {

struct GeodesicElementsOptions {
  bool kept_strips = true;
  /// Length of the mollifier (thesis eq. 3.12) as a fraction of an edge; 0 leaves it out.
  double mollifier_length = 0;
  /// Whether points that cross a cut locus are put there, on hosts that do not give way.
  bool cut_loci = true;
};

/// The energy of all elements that follow shortest paths: springs, weight (g - rest_length)^2 of the length g of one
/// path (thesis eq. 3.13), and the triangles of membranes, neo-Hookean functions of the lengths of three (eq. 3.17
/// to 3.20). On a host that gives way they pull on its nodes too (eq. 3.21 and 3.22).
///
/// A path *pulls* at its ends by the derivative of E by its length, positive under tension. What E is like there: each
/// smooth piece of a squared distance is convex to second order (see surface::SquaredDistances). Across an edge, and
/// where a path begins to bend at a saddle vertex, E is continuously differentiable. At a cut locus and at a vertex of
/// less than 2 pi it is the least of several pieces, never at a minimum. At a saddle or boundary vertex it is like the
/// tip of a cone, where a point may come to rest whatever small changes the others undergo: there the gradient is the
/// least slope of all directions, zero at a minimum. A point that is pushed across an edge of the boundary rests
/// against it: the gradient is then what is left along the edge. Next to one whose excess of angle is small, E bends as
/// sharply within a narrow wedge behind the vertex, in which paths are held.
///
/// Where a path pushes, E has a valley at its cut locus, with a kink at the bottom: there it is the greatest of several
/// pieces, one for each of the shortest paths. A state may have paths that are kept there (CutLocus). Their ends move
/// along the valley only, by the derivatives of the lengths' convex combination that leaves the least gradient (a
/// stationary point in the sense of Clarke 1983 is where nothing is left), so that Newton's method converges as
/// elsewhere; a path that holds its ends by itself is let go. A line search hits no valley by chance: `kinks` names
/// those that a step crossed. Rigid and moving hosts only.
///
/// A line search cannot bring a point to a vertex by chance, and one point that steps over such a place shortens the
/// way of all. So where a step was shortened, the points whose elements surprised it are moved by themselves, one after
/// the other, to their own minima while all others go their whole way; a point that rests at a vertex near by is put
/// there
/// (`kinks`).
class GeodesicElements : public numerics::Term<NetworkState> {
 public:
  /// The network is a checked one; `solver` outlives the term, and is that of the surface as it is at first, where the
  /// host gives way. Points that are held are not tried at vertices.
  GeodesicElements(const surface::GeodesicSolver& solver, const Network& network, std::vector<bool> held,
                   GeodesicElementsOptions options);

  /// Goes on with the strips that the same network's term found on the same mesh, which has moved since.
  void take_strips(const GeodesicElements& other) { last_ = other.last_; }

  std::string_view name() const override { return "geodesic_elements"; }
  /// On a host that gives way: see surface::convex_host_hessian.
  bool has_convex_hessian() const override { return true; }
  void prepare(NetworkState& state, int order, const Execution& execution) override;
  void add(const NetworkState& state, int order, numerics::EnergySum& sum) const override;
  /// No point goes farther than a few diagonals of the mesh: where hardly anything holds it, it could go round for
  /// ever.
  double largest_step(const NetworkState& state, const Eigen::VectorXd& step) const override;
  bool has_kinks() const override { return true; }
  std::vector<Kink> kinks(const NetworkState& current, const std::vector<NetworkState>& tried,
                          double reach) const override;
  void bill(CostLedger& cost, double seconds) const override;

  /// Lengths of a triangle's sides where the paths are found.
  Eigen::Vector3d lengths_of(const FoundPaths& found, std::size_t triangle) const;
  const TriangleEnergy& energy_of(std::size_t triangle) const { return triangles_[triangle].energy; }
  /// Points at which paths end that push and are not the only shortest ones; held ones are left out.
  std::vector<bool> ends_that_push_at_cut_loci(const FoundPaths& found) const;
  /// Whether a side of a triangle is the only shortest path between its ends.
  bool side_is_unique(const FoundPaths& found, std::size_t triangle, int side) const {
    return found.is_unique(triangles_[triangle].sides[static_cast<std::size_t>(side)].path);
  }

 private:
  /// The ends of a path: points.
  struct Ends {
    std::int32_t from;
    std::int32_t to;
  };
  /// A side of a triangle is a path whose ends are two of the corners.
  struct Side {
    std::size_t path;
    int from_corner;
    int to_corner;
  };
  struct Triangle {
    MembraneTriangle given;
    std::array<Side, 3> sides;
    TriangleEnergy energy;
  };
  /// Paths that end at a point on a tip, with what they pull.
  struct Arrivals {
    std::vector<surface::ArrivingPath> paths;
    double stiffness = 0;  ///< sum of the second derivatives by their lengths, where positive
    bool parted = false;   ///< some path has a length
    bool valid = true;
  };
  using PathOf = std::function<const surface::TangentGeodesic&(std::size_t path)>;

  const surface::GeodesicSolver& solver_of(const NetworkState& state) const {
    return state.surface() ? *state.surface() : solver_;
  }
  void find_paths(NetworkState& state, const Execution& execution);
  void find_host_lengths(NetworkState& state, int order, const Execution& execution) const;
  std::shared_ptr<FoundPaths> unused_paths();
  void find_mollified(FoundPaths& found, const Execution& execution) const;
  /// Makes the ends all but rigid across cut loci.
  void hold_at_cut_loci(const NetworkState& state, numerics::EnergySum& sum) const;
  /// Shares the force of such paths out, now that all lengths are known.
  void share_out(NetworkState& state, FoundPaths& found, std::vector<EqualPaths> equal) const;
  /// The energy's derivatives by the lengths of all paths.
  std::vector<double> pulls_at(const FoundPaths& found) const;
  struct Crossed {
    double surprise;  ///< how much more energy the step left than was foretold
    double share;     ///< of the step, up to the cut locus
    CutLocus locus;   ///< as it is there, in the coordinates before the step
  };
  /// Where another path has become shorter on the way between two states than this one, which pushes; nothing where
  /// none has.
  std::optional<Crossed> cut_locus_crossed(std::size_t path, double pull, const NetworkState& current,
                                           const NetworkState& there) const;
  struct CrossedOnWay {
    Crossed crossed;
    Eigen::VectorXd step;  ///< that crossed it
  };
  /// The nearest cut locus that each path crossed, the most surprising first.
  std::vector<CrossedOnWay> cut_loci_on_ways(const NetworkState& current, const std::vector<NetworkState>& tried) const;
  /// States near by that have one more path at a cut locus, which a step crossed.
  std::vector<Kink> cut_loci_crossed(const NetworkState& current, const std::vector<NetworkState>& tried) const;
  LengthDerivatives length_of(const FoundPaths& found, std::size_t path, bool second) const;
  /// An element's share of the energy at a state whose paths are found.
  SpringElement spring_at(const FoundPaths& found, std::size_t spring, int order) const;
  TriangleElement triangle_at(const FoundPaths& found, std::size_t triangle, int order) const;
  /// The same with the nodes' share, on a host that gives way, where the lengths' derivatives are known.
  HostElement host_spring_at(const NetworkState& state, std::size_t spring, int order, bool convex) const;
  HostElement host_triangle_at(const NetworkState& state, std::size_t triangle, int order, bool convex) const;
  HostLength host_length_at(const NetworkState& state, std::size_t path, int order, bool convex) const;
  /// A point that its elements push across an edge of the boundary, and the way out in its coordinates.
  struct Wall {
    std::int32_t point;
    Eigen::Vector2d out;
  };
  using Walls = std::vector<Wall>;  ///< by ascending points
  Walls walls_at(const NetworkState& state) const;
  static const Wall* wall_of(const Walls& walls, std::int32_t point);
  /// All elements, as their points can move: not on tips, which are added by themselves, and not through walls.
  void add_elements(const NetworkState& state, int order, const Walls& walls, numerics::EnergySum& sum) const;
  void add_on_rigid_host(const NetworkState& state, int order, const Walls& walls, numerics::EnergySum& sum) const;
  void add_on_host(const NetworkState& state, int order, const Walls& walls, numerics::EnergySum& sum) const;
  /// What arrives at a point of an elastic system whose paths are these.
  Arrivals arrivals_at(std::size_t point, const PathOf& path) const;
  void add_on_tip(const NetworkState& state, std::size_t point, int order, numerics::EnergySum& sum) const;
  /// The points whose elements make the energy at `whole` exceed most what the derivatives at `current` foretell of it,
  /// the worst first.
  std::vector<std::size_t> surprised(const NetworkState& current, const NetworkState& whole) const;
  /// The elements of one point, which is point 0 of them, with the others at the state.
  Network elements_of(std::size_t point, const NetworkState& state) const;
  double stiffness_at(std::size_t point) const;
  /// Moves points one after the other, each from `starts`, to where its own elements pull it with the others held.
  void settle(NetworkState& state, const std::vector<std::size_t>& points, const NetworkState& starts) const;
  /// States that have one free point at a vertex near by where it rests.
  std::vector<Kink> kinks_of(std::size_t point, const NetworkState& current,
                             const std::vector<NetworkState>& tried) const;
  /// The state with those points at a vertex where paths bend which only rounding keeps from there: none of their
  /// directions is right beyond it. From there they leave by the steepest descent. None where there is no such point.
  std::optional<Kink> points_put_at_vertices(const NetworkState& current) const;
  /// Whether a point would rest at the vertex with all others where they are.
  bool rests_at(const NetworkState& state, std::size_t point, std::int32_t vertex) const;

  const surface::GeodesicSolver& solver_;
  std::vector<Spring> springs_;  ///< spring i is along path i
  std::vector<Triangle> triangles_;
  MembraneMaterial material_;
  std::vector<Ends> paths_;
  std::vector<std::vector<std::int32_t>> springs_at_;    ///< of each point
  std::vector<std::vector<std::int32_t>> triangles_at_;  ///< of each point
  std::vector<bool> held_;
  std::vector<std::size_t> free_;  ///< points that are not held and have elements
  GeodesicElementsOptions options_;
  std::vector<surface::PointPair> pairs_;   ///< the paths' ends at the state that was prepared last
  std::shared_ptr<const FoundPaths> last_;  ///< where strips are taken from
  std::vector<std::shared_ptr<FoundPaths>> kept_paths_;
};

}  // namespace supple::embedded
