#include "network_state.h"

#include <Eigen/Geometry>
#include <utility>

#include "supple/base/error.h"

namespace supple::embedded {

LengthDerivatives FoundPaths::length_with_derivatives(std::size_t path, bool second) const {
  if (!mollified.empty()) return mollified[path];
  if (const EqualPaths* own = equal_to(path)) return own->length;
  const surface::TangentGeodesic& geodesic = geodesics[path];
  LengthDerivatives result;
  result.length = geodesic.distance;
  result.gradient << -geodesic.from_direction, geodesic.to_direction;
  if (second) result.hessian = geodesic.hessian();
  return result;
}

NetworkState::NetworkState(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> points)
    : mesh_(&mesh), points_(mesh, std::move(points)) {}

NetworkState::NetworkState(std::shared_ptr<const surface::GeodesicSolver> surface,
                           std::vector<surface::SurfacePoint> points, Eigen::VectorXd nodes)
    : NetworkState(surface->mesh(), std::move(points)) {
  surface_ = std::move(surface);
  nodes_ = std::move(nodes);
}

void NetworkState::place(std::size_t point, const surface::SurfacePoint& at) {
  points_.place(mesh(), point, at);
  forget_paths();
}

Eigen::VectorXd NetworkState::move(const Eigen::VectorXd& step) {
  forget_paths();
  last_step_ = step;
  turns_.assign(points().size(), 0);
  Eigen::VectorXd travelled(dimension());
  walk(step, travelled);
  if (nodes_.size() > 0) {
    travelled.tail(nodes_.size()) = step.tail(nodes_.size());
    move_nodes(step.tail(nodes_.size()));
  }
  return travelled;
}

void NetworkState::walk(const Eigen::VectorXd& step, Eigen::VectorXd& travelled) {
  travelled.head(points_.dimension()) = points_.move(mesh(), step);
  for (std::size_t i = 0; i < turns_.size(); ++i) turns_[i] += points_.turn(i);
  for (CutLocus& locus : cut_loci_)
    for (Eigen::Vector4d& side : locus.sides) {
      side.head<2>() = (Eigen::Rotation2Dd(points_.turn(static_cast<std::size_t>(locus.from))) * side.head<2>()).eval();
      side.tail<2>() = (Eigen::Rotation2Dd(points_.turn(static_cast<std::size_t>(locus.to))) * side.tail<2>()).eval();
    }
}

void NetworkState::adjust(const Eigen::VectorXd& step) {
  forget_paths();
  if (last_step_.size() == 0) last_step_ = Eigen::VectorXd::Zero(dimension());
  turns_.resize(points().size(), 0);
  for (std::size_t i = 0; i < turns_.size(); ++i)
    last_step_.segment<2>(2 * static_cast<Eigen::Index>(i)) +=
        Eigen::Rotation2Dd(-turns_[i]) * step.segment<2>(2 * static_cast<Eigen::Index>(i));
  Eigen::VectorXd travelled(dimension());
  walk(step, travelled);
}

void NetworkState::forget_paths() {
  found_.reset();
  host_lengths_.reset();
}

void NetworkState::move_nodes(const Eigen::VectorXd& step) {
  if (step.isZero(0)) return;
  nodes_ += step;
  const surface::TriangleMesh& before = surface_->mesh();
  std::vector<Eigen::Vector3d> positions(static_cast<std::size_t>(before.vertex_count()));
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = node(static_cast<std::int32_t>(i));
  try {
    surface_ = std::make_shared<surface::GeodesicSolver>(
        std::make_shared<const surface::TriangleMesh>(before.with_positions(std::move(positions))));
  } catch (const Error&) {
    collapsed_ = true;
    return;
  }
  points_.look_at(mesh());
}

}  // namespace supple::embedded
