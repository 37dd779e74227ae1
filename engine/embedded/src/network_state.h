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

/// A path that pushes its ends apart and is kept where other paths between them are as short, as its energy has a
/// valley there (thesis sec. 3.4.2 leaves such places out).
struct CutLocus {
  std::size_t path = 0;
  std::int32_t from = 0;  ///< points
  std::int32_t to = 0;
  /// For each of the shortest paths a unit change of both ends' tangent coordinates after which it is the only one.
  std::vector<Eigen::Vector4d> sides{};
  /// Whether the next step keeps to it even where one of the paths could hold the ends by itself, since a step by that
  /// path's derivatives alone would cross it at once.
  bool for_next_step = false;
};

/// The shortest paths of a cut locus where the ends are now.
struct EqualPaths {
  std::size_t path = 0;
  std::vector<surface::TangentGeodesic> geodesics{};
  Eigen::VectorXd shares{};  ///< of the path's force, one for each; their sum is 1
  /// Derivatives of the length with these shares. Where one share is 1, that path holds the ends by itself, and the
  /// others are let go.
  LengthDerivatives length{};
  std::vector<Eigen::Vector4d> across{};  ///< unit changes of the ends that lead away from the cut locus
};

/// What is known of the paths between points where these are now: found once for a state, shared by its copies.
struct FoundPaths {
  std::vector<surface::TangentGeodesic> geodesics;
  std::vector<EqualPaths> equal;                       ///< by ascending paths; on a rigid or moving host
  std::vector<LengthDerivatives> mollified;            ///< empty without the mollifier
  std::vector<std::vector<surface::PathPoint>> paths;  ///< the paths themselves, on a host that gives way; else empty

  /// Null where a path is at no cut locus.
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

/// Points that move on a surface (surface::MovingPoints). On a host that gives way, its nodes follow, three coordinates
/// each: the first of them are the vertices of the surface, on which points keep their barycentric coordinates when
/// nodes move.
class NetworkState {
 public:
  /// On a rigid surface. `mesh` outlives the state.
  NetworkState(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> points);
  /// On a surface that gives way. `nodes` has three coordinates for each node, as many nodes as the surface has
  /// vertices or more, and the surface's are where its vertices are.
  NetworkState(std::shared_ptr<const surface::GeodesicSolver> surface, std::vector<surface::SurfacePoint> points,
               Eigen::VectorXd nodes);

  void stop_with(const CancellationToken& cancellation) { points_.stop_with(cancellation); }
  const CancellationToken& cancellation() const { return points_.cancellation(); }

  /// The surface as it is now.
  const surface::TriangleMesh& mesh() const { return surface_ ? surface_->mesh() : *mesh_; }
  /// The solver on a surface that gives way; null on a rigid one.
  const std::shared_ptr<const surface::GeodesicSolver>& surface() const { return surface_; }
  const std::vector<surface::SurfacePoint>& points() const { return points_.points(); }
  bool on_tip(std::size_t point) const { return points_.on_tip(point); }
  /// The vertex that a point on a tip is at.
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

  /// The same with one point elsewhere.
  void place(std::size_t point, const surface::SurfacePoint& at);

  /// The last move as it was asked for, with what brought paths back to their cut loci; empty before.
  const Eigen::VectorXd& last_step() const { return last_step_; }
  /// Radians by which that turned a point's coordinates.
  double turn(std::size_t point) const { return turns_[point]; }

  /// Paths that are kept at cut loci, ascending. They stay there when points move, once their paths are found.
  const std::vector<CutLocus>& cut_loci() const { return cut_loci_; }
  void set_cut_loci(std::vector<CutLocus> loci) { cut_loci_ = std::move(loci); }
  /// The points walk a little farther, as a part of the last move.
  void adjust(const Eigen::VectorXd& step);

  /// Null before they are found.
  const FoundPaths* found() const { return found_.get(); }
  const std::shared_ptr<const FoundPaths>& shared_found() const { return found_; }
  void set_found(std::shared_ptr<const FoundPaths> found) { found_ = std::move(found); }

  /// On a host that gives way; null before they are worked out.
  const HostLengths* host_lengths() const { return host_lengths_.get(); }
  void set_host_lengths(std::shared_ptr<const HostLengths> lengths) { host_lengths_ = std::move(lengths); }

  static constexpr std::string_view motion = "motion";
  Eigen::Index dimension() const { return points_.dimension() + nodes_.size(); }
  /// The points walk; then the nodes move, and carry the points with them.
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
  std::vector<double> turns_;  ///< of the last move
  std::vector<CutLocus> cut_loci_;
  std::shared_ptr<const FoundPaths> found_;
  std::shared_ptr<const HostLengths> host_lengths_;
};

}  // namespace supple::embedded
