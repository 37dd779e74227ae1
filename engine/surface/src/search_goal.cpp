#include "search_goal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "search_target.h"

namespace supple::surface {
namespace {

/// A difference of squares has lost too many digits if it is below this fraction of the minuend.
constexpr double cancellation_ratio = 1e-4;

}  // namespace

void SearchGoal::start(const SearchMesh& mesh, const SurfacePoint& goal, std::span<const double> landmark,
                       double landmark_distance) {
  mesh_ = &mesh;
  landmark_ = landmark;
  landmark_distance_ = landmark_distance;
  const std::int32_t corner = nearest_corner(*mesh.mesh, goal);
  corner_ = mesh.mesh->positions()[corner];
  offset_ = offset_from(*mesh.mesh, goal, corner);
}

double SearchGoal::min_distance_of(const SurfacePoint& source) const {
  const std::int32_t corner = nearest_corner(*mesh_->mesh, source);
  double distance = (vector_from(corner) - offset_from(*mesh_->mesh, source, corner)).norm();
  if (landmark_.empty()) return distance;
  for (const std::int32_t v : mesh_->mesh->faces()[index(source.face)]) {
    const double source_to_corner = offset_from(*mesh_->mesh, source, v).norm();
    distance = std::max(distance, min_distance_by_landmark(v) - source_to_corner);
  }
  return distance;
}

Eigen::Vector2d SearchGoal::in_frame(std::int32_t tail, std::int32_t head, double length) const {
  const std::vector<Eigen::Vector3d>& positions = mesh_->mesh->positions();
  const Eigen::Vector3d edge = positions[head] - positions[tail];
  const Eigen::Vector3d relative = vector_from(tail);
  const double along = edge.dot(relative) / length;
  const double squared = relative.squaredNorm();
  const double height = squared - along * along;
  if (height > cancellation_ratio * squared) return {along, std::sqrt(height)};
  // The height of a goal next to the edge's line cancels in the difference of squares, but not in the triangle's area.
  return {along, edge.cross(relative).norm() / length};
}

}  // namespace supple::surface
