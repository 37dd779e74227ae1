#pragma once

#include <Eigen/Core>
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

/// What is known of the paths between points where these are now: found once for a state, shared by its copies.
struct FoundPaths {
  std::vector<surface::TangentGeodesic> geodesics;
  std::vector<LengthDerivatives> mollified;            ///< empty without the mollifier
  std::vector<std::vector<surface::PathPoint>> paths;  ///< the paths themselves, on a host that gives way; else empty
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

  /// The surface as it is now.
  const surface::TriangleMesh& mesh() const { return surface_ ? surface_->mesh() : *mesh_; }
  /// Of a surface that gives way; null on a rigid one.
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

  /// The last move as it was asked for; empty before.
  const Eigen::VectorXd& last_step() const { return last_step_; }

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
  void move_nodes(const Eigen::VectorXd& step);
  void forget_paths();

  const surface::TriangleMesh* mesh_;
  std::shared_ptr<const surface::GeodesicSolver> surface_;
  Eigen::VectorXd nodes_;
  bool collapsed_ = false;
  surface::MovingPoints points_;
  Eigen::VectorXd last_step_;
  std::shared_ptr<const FoundPaths> found_;
  std::shared_ptr<const HostLengths> host_lengths_;
};

}  // namespace supple::embedded
