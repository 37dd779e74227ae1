#pragma once

#include <Eigen/Core>
#include <memory>
#include <string_view>
#include <vector>

#include "supple/numerics/state.h"
#include "supple/surface/retraction.h"
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
  std::vector<LengthDerivatives> mollified;  ///< empty without the mollifier
};

/// Points that move on a surface, two tangent coordinates each: of tangent_frame of the point's face or, on the tip of
/// a cone (a vertex), of surface::cone_coordinates.
class NetworkState {
 public:
  /// `mesh` outlives the state.
  NetworkState(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> points);

  const surface::TriangleMesh& mesh() const { return *mesh_; }
  const std::vector<surface::SurfacePoint>& points() const { return points_; }
  bool on_tip(std::size_t point) const { return on_tip_[point] != 0; }
  /// The vertex that a point on a tip is at.
  std::int32_t vertex_of(std::size_t point) const;

  /// The same with one point elsewhere.
  void place(std::size_t point, const surface::SurfacePoint& at);

  /// The last move as it was asked for; empty before.
  const Eigen::VectorXd& last_step() const { return last_step_; }

  /// Null before they are found.
  const FoundPaths* found() const { return found_.get(); }
  const std::shared_ptr<const FoundPaths>& shared_found() const { return found_; }
  void set_found(std::shared_ptr<const FoundPaths> found) { found_ = std::move(found); }

  static constexpr std::string_view motion = "motion";
  Eigen::Index dimension() const { return 2 * static_cast<Eigen::Index>(points_.size()); }
  /// Each point walks its own straightest path, and is stopped by a boundary by itself.
  Eigen::VectorXd move(const Eigen::VectorXd& step);
  void take_frame() {}
  /// Turns each point's part as its way turned it. The way to or from a tip has no transport: there coordinates stay,
  /// which is an isometry too, and one point at a vertex does not make the others forget their curvature.
  bool transport(Eigen::VectorXd& tangent) const;

 private:
  const surface::TriangleMesh* mesh_;
  std::vector<surface::SurfacePoint> points_;
  std::vector<std::uint8_t> on_tip_;
  Eigen::VectorXd last_step_;
  std::vector<double> turns_;  ///< of each point's coordinates along the last move
  std::shared_ptr<const FoundPaths> found_;
};

}  // namespace supple::embedded
