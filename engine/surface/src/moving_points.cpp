#include "supple/surface/moving_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/threads.h"

namespace supple::surface {
namespace {

/// Number of points that one task moves; each takes about a microsecond.
constexpr std::size_t points_per_task = 512;

}  // namespace

MovingPoints::MovingPoints(const TriangleMesh& mesh, std::vector<SurfacePoint> points)
    : points_(std::move(points)), on_tip_(points_.size()), turns_(points_.size(), 0) {
  look_at(mesh);
}

void MovingPoints::look_at(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < points_.size(); ++i) on_tip_[i] = on_cone_tip(mesh, points_[i]) ? 1 : 0;
}

std::int32_t MovingPoints::vertex_of(const TriangleMesh& mesh, std::size_t point) const {
  const SurfacePoint& at = points_[point];
  return mesh.faces()[index(at.face)][corner_of(at)];
}

void MovingPoints::place(const TriangleMesh& mesh, std::size_t point, const SurfacePoint& at) {
  points_[point] = at;
  on_tip_[point] = on_cone_tip(mesh, at) ? 1 : 0;
  turns_[point] = 0;
}

Eigen::VectorXd MovingPoints::move(const TriangleMesh& mesh, const Eigen::VectorXd& step) {
  Eigen::VectorXd travelled = Eigen::VectorXd::Zero(dimension());
  const auto move_point = [&](std::size_t i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    turns_[i] = 0;
    const Eigen::Vector2d point_step = step.segment<2>(row);
    if (point_step.isZero(0)) return;
    const Retraction moved = retract(mesh, points_[i], point_step, cancellation_);
    travelled.segment<2>(row) = moved.travelled;
    if (moved.isometric && on_tip_[i] == 0) turns_[i] = moved.turn;
    points_[i] = moved.end;
    on_tip_[i] = on_cone_tip(mesh, moved.end) ? 1 : 0;
  };
  const std::size_t tasks = (points_.size() + points_per_task - 1) / points_per_task;
  const auto move_task = [&](int task) {
    const std::size_t begin = static_cast<std::size_t>(task) * points_per_task;
    for (std::size_t i = begin; i < std::min(points_.size(), begin + points_per_task); ++i) move_point(i);
  };
  if (tasks > 1)
    parallel_for(static_cast<int>(tasks), move_task);
  else
    move_task(0);
  return travelled;
}

void MovingPoints::transport(Eigen::VectorXd& tangent) const {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (turns_[i] == 0) continue;
    const double c = std::cos(turns_[i]);
    const double s = std::sin(turns_[i]);
    auto part = tangent.segment<2>(2 * static_cast<Eigen::Index>(i));
    part = Eigen::Vector2d(c * part[0] - s * part[1], s * part[0] + c * part[1]);
  }
}

}  // namespace supple::surface
