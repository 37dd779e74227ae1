#include "network_state.h"

#include <utility>

#include "supple/base/error.h"

namespace supple::embedded {

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
  Eigen::VectorXd travelled(dimension());
  travelled.head(points_.dimension()) = points_.move(mesh(), step);
  if (nodes_.size() > 0) {
    travelled.tail(nodes_.size()) = step.tail(nodes_.size());
    move_nodes(step.tail(nodes_.size()));
  }
  return travelled;
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
