#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "supple/numerics/state.h"
#include "supple/surface/geodesic_derivatives.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/surface/moving_points.h"
#include "supple/surface/tangent_geodesic.h"

namespace supple::embedded {

/// The length of a path with its derivatives by the tangent coordinates of both ends.
struct LengthDerivatives {
  double length = 0;
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();
};

/// A path under compression that is kept where other paths between its ends are as short, because its energy has a
/// valley there. [Thesis, sec. 3.4.2] leaves such places out.
struct CutLocus {
  std::size_t path = 0;
  std::int32_t from = 0;  ///< points at the ends
  std::int32_t to = 0;
  /// For each of the shortest paths a unit change of both ends' tangent coordinates after which it is the only one.
  std::vector<Eigen::Vector4d> sides{};
  /// Whether all of the shortest paths are retained for the next step, also those without force: a step by the
  /// derivatives of one path alone would cross the cut locus at once.
  bool for_next_step = false;
};

/// The equally short paths of a cut locus at the present ends.
struct EqualPaths {
  std::size_t path = 0;
  std::vector<surface::TangentGeodesic> geodesics{};
  Eigen::VectorXd fractions{};            ///< fractions of the path's force, one for each geodesic; their sum is 1
  LengthDerivatives length{};             ///< with the convex combination of the derivatives by these fractions
  std::vector<Eigen::Vector4d> across{};  ///< unit changes of the ends that lead away from the cut locus
};

/// The shortest paths at one state. They are found once, and copies of the state share them.
struct FoundPaths {
  std::vector<surface::TangentGeodesic> geodesics;
  std::vector<EqualPaths> equal;                       ///< paths at cut loci, ascending; on a rigid or moving host
  std::vector<LengthDerivatives> mollified;            ///< empty without the mollifier
  std::vector<std::vector<surface::PathPoint>> paths;  ///< points of each path on a deformable host; else empty

  /// The length of a path.
  double length_of(std::size_t path) const {
    if (!mollified.empty()) return mollified[path].length;
    const EqualPaths* own = equal_to(path);
    return own ? own->length.length : geodesics[path].distance;
  }
  /// The same with the first derivatives and, if `second`, the second ones.
  LengthDerivatives length_with_derivatives(std::size_t path, bool second) const;
  /// The equally short paths of a path that is at a cut locus; null for others.
  const EqualPaths* equal_to(std::size_t path) const {
    const auto at = std::ranges::lower_bound(equal, path, {}, &EqualPaths::path);
    return at != equal.end() && at->path == path ? &*at : nullptr;
  }
  bool is_unique(std::size_t path) const {
    const EqualPaths* own = equal_to(path);
    return geodesics[path].unique && !(own && own->geodesics.size() > 1);
  }
};

/// The lengths' derivatives by points and nodes at one state.
struct HostLengths {
  int order = 0;
  std::vector<surface::HostDerivatives> lengths;
};

/// Points that move on a surface (surface::MovingPoints). On a deformable host the degrees of freedom of its nodes
/// follow, three coordinates each. The first nodes are the vertices of the surface. Points keep their barycentric
/// coordinates when nodes move.
class NetworkState {
 public:
  /// On a rigid surface. `mesh` outlives the state.
  NetworkState(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> points);
  /// On a deformable surface. `nodes` has three coordinates for each node; the first nodes are the surface's vertices,
  /// in their order and at their places.
  NetworkState(std::shared_ptr<const surface::GeodesicSolver> surface, std::vector<surface::SurfacePoint> points,
               Eigen::VectorXd nodes);

  void stop_with(const CancellationToken& cancellation) { points_.stop_with(cancellation); }
  const CancellationToken& cancellation() const { return points_.cancellation(); }

  /// The surface as it is now.
  const surface::TriangleMesh& mesh() const { return surface_ ? surface_->mesh() : *mesh_; }
  /// The solver on a deformable surface; null on a rigid one.
  const std::shared_ptr<const surface::GeodesicSolver>& surface() const { return surface_; }
  const std::vector<surface::SurfacePoint>& points() const { return points_.points(); }
  /// Whether a point is at a vertex where paths may bend, so that the surface is like the tip of a cone there.
  bool on_tip(std::size_t point) const { return points_.on_tip(point); }
  /// The vertex of a point for which `on_tip` is true.
  std::int32_t vertex_of(std::size_t point) const { return points_.vertex_of(mesh(), point); }

  /// Coordinates of the host's nodes, three for each; empty on a rigid surface.
  const Eigen::VectorXd& nodes() const { return nodes_; }
  Eigen::Vector3d node(std::int32_t number) const { return nodes_.segment<3>(3 * static_cast<Eigen::Index>(number)); }
  /// The first of a node's three rows.
  std::int32_t node_row(std::int32_t number) const {
    return static_cast<std::int32_t>(points_.dimension()) + 3 * number;
  }
  /// Whether a face of the surface has lost its area: no path is then known, and the state has no energy.
  bool collapsed() const { return collapsed_; }

  /// Moves one point to another place.
  void place(std::size_t point, const surface::SurfacePoint& at);

  /// The step of the last move, plus the adjustments that brought paths back to their cut loci; empty before a move.
  const Eigen::VectorXd& last_step() const { return last_step_; }
  /// Angle by which the last move turned a point's tangent coordinates, radians.
  double turn(std::size_t point) const { return turns_[point]; }

  /// Paths that are kept at cut loci, ascending. PathCache::find brings their ends back there after a move.
  const std::vector<CutLocus>& cut_loci() const { return cut_loci_; }
  void set_cut_loci(std::vector<CutLocus> loci) { cut_loci_ = std::move(loci); }
  /// Moves the points a little farther, as a part of the last move.
  void adjust(const Eigen::VectorXd& step);

  /// The shortest paths; null before they are found.
  const FoundPaths* found() const { return found_.get(); }
  const std::shared_ptr<const FoundPaths>& shared_found() const { return found_; }
  void set_found(std::shared_ptr<const FoundPaths> found) { found_ = std::move(found); }

  /// On a deformable host; null before they are computed.
  const HostLengths* host_lengths() const { return host_lengths_.get(); }
  void set_host_lengths(std::shared_ptr<const HostLengths> lengths) { host_lengths_ = std::move(lengths); }

  static constexpr std::string_view motion = "motion";
  Eigen::Index dimension() const { return points_.dimension() + nodes_.size(); }
  /// First the points walk on the surface; then the nodes move and carry the points along.
  Eigen::VectorXd move(const Eigen::VectorXd& step);
  void take_frame() {}
  bool transport(Eigen::VectorXd& tangent) const {
    points_.transport(tangent);
    return true;
  }

 private:
  void walk(const Eigen::VectorXd& step, Eigen::VectorXd& travelled);
  void move_nodes(const Eigen::VectorXd& step);
  void forget_paths();

  const surface::TriangleMesh* mesh_;
  std::shared_ptr<const surface::GeodesicSolver> surface_;
  Eigen::VectorXd nodes_;
  bool collapsed_ = false;
  surface::MovingPoints points_;
  Eigen::VectorXd last_step_;
  std::vector<double> turns_;  ///< see `turn`
  std::vector<CutLocus> cut_loci_;
  std::shared_ptr<const FoundPaths> found_;
  std::shared_ptr<const HostLengths> host_lengths_;
};

}  // namespace supple::embedded
