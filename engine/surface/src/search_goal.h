#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>

#include "vertex_table.h"
#include "window.h"

namespace supple::surface {

/// The target of a goal-directed search, and lower bounds of distances to it.
class SearchGoal {
 public:
  /// `landmark` has the exact distance of each vertex from a point near the goal, whose distance from the goal is at
  /// most `landmark_distance`; empty for none.
  void start(const SearchMesh& mesh, const SurfacePoint& goal, std::span<const double> landmark,
             double landmark_distance);
  /// Begins a search without a goal.
  void clear() { landmark_ = {}; }

  /// Lower bound of a source's distance to the goal.
  double min_distance_of(const SurfacePoint& source) const;
  /// Lower bound of a vertex's distance to the goal.
  double min_distance(std::int32_t vertex) const {
    return std::max(min_distance_by_landmark(vertex), vector_from(vertex).norm());
  }
  /// The same by the landmark alone; -infinity without one.
  double min_distance_by_landmark(std::int32_t vertex) const {
    return landmark_.empty() ? -infinity : landmark_[vertex] - landmark_distance_;
  }
  bool has_landmark() const { return !landmark_.empty(); }
  /// The goal, rotated about the edge into the plane of the next face. Its distance from a point of the edge is the
  /// distance in space, a lower bound of a path's length.
  Eigen::Vector2d in_frame(std::int32_t tail, std::int32_t head, double length) const;

 private:
  /// Vector from a vertex to the goal. Unlike the goal's position, it has all its digits if the goal is next to the
  /// vertex.
  Eigen::Vector3d vector_from(std::int32_t vertex) const {
    return (corner_ - mesh_->mesh->positions()[vertex]) + offset_;
  }

  const SearchMesh* mesh_ = nullptr;
  std::span<const double> landmark_;
  double landmark_distance_ = 0;
  Eigen::Vector3d corner_ = Eigen::Vector3d::Zero();  ///< position of the goal's nearest_corner
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();  ///< vector from that corner to the goal
};

}  // namespace supple::surface
