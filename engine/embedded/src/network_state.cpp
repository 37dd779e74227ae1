#include "network_state.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/threads.h"

namespace supple::embedded {
namespace {

/// Points that one task moves: each takes about a microsecond.
constexpr std::size_t points_of_a_task = 512;

}  // namespace

NetworkState::NetworkState(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> points)
    : mesh_(&mesh), points_(std::move(points)), on_tip_(points_.size()), turns_(points_.size(), 0) {
  for (std::size_t i = 0; i < points_.size(); ++i) on_tip_[i] = surface::on_cone_tip(mesh, points_[i]) ? 1 : 0;
}

NetworkState::NetworkState(std::shared_ptr<const surface::GeodesicSolver> surface,
                           std::vector<surface::SurfacePoint> points, Eigen::VectorXd nodes)
    : NetworkState(surface->mesh(), std::move(points)) {
  surface_ = std::move(surface);
  nodes_ = std::move(nodes);
}

std::int32_t NetworkState::vertex_of(std::size_t point) const {
  const surface::SurfacePoint& at = points_[point];
  return mesh().faces()[index(at.face)][surface::corner_of(at)];
}

void NetworkState::place(std::size_t point, const surface::SurfacePoint& at) {
  points_[point] = at;
  on_tip_[point] = surface::on_cone_tip(mesh(), at) ? 1 : 0;
  turns_[point] = 0;
  forget_paths();
}

Eigen::VectorXd NetworkState::move(const Eigen::VectorXd& step) {
  Eigen::VectorXd travelled = Eigen::VectorXd::Zero(dimension());
  forget_paths();
  last_step_ = step;
  const auto move_point = [&](std::size_t i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    turns_[i] = 0;
    const Eigen::Vector2d own = step.segment<2>(row);
    if (own.isZero(0)) return;
    const surface::Retraction moved = surface::retract(mesh(), points_[i], own);
    travelled.segment<2>(row) = moved.travelled;
    if (moved.isometric && !on_tip_[i]) turns_[i] = moved.turn;
    points_[i] = moved.end;
    on_tip_[i] = surface::on_cone_tip(mesh(), moved.end) ? 1 : 0;
  };
  const std::size_t tasks = (points_.size() + points_of_a_task - 1) / points_of_a_task;
  const auto move_some = [&](int task) {
    const std::size_t begin = static_cast<std::size_t>(task) * points_of_a_task;
    for (std::size_t i = begin; i < std::min(points_.size(), begin + points_of_a_task); ++i) move_point(i);
  };
  if (tasks > 1)
    parallel_for(static_cast<int>(tasks), move_some);
  else
    move_some(0);
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
  for (std::size_t i = 0; i < points_.size(); ++i) on_tip_[i] = surface::on_cone_tip(mesh(), points_[i]) ? 1 : 0;
}

bool NetworkState::transport(Eigen::VectorXd& tangent) const {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (turns_[i] == 0) continue;
    const double c = std::cos(turns_[i]);
    const double s = std::sin(turns_[i]);
    auto part = tangent.segment<2>(2 * static_cast<Eigen::Index>(i));
    part = Eigen::Vector2d(c * part[0] - s * part[1], s * part[0] + c * part[1]);
  }
  return true;
}

}  // namespace supple::embedded
