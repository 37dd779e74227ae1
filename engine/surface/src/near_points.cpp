#include "near_points.h"

#include <algorithm>
#include <numeric>

#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

constexpr std::int32_t leaf_size = 8;

/// Points in a balanced k-d tree. The children of node `k` are the nodes 2 k + 1 and 2 k + 2. Each of them has one half
/// of the node's range [begin, end) of `order_`.
class PointTree {
 public:
  PointTree(const std::vector<Eigen::Vector3d>& points, const Execution& execution)
      : points_(points), order_(points.size()), pace_(execution.cancellation) {
    std::iota(order_.begin(), order_.end(), 0);
    build(0, 0, static_cast<std::int32_t>(order_.size()));
  }

  /// Calls visit(i) for each point i that is no further than `distance` from `center`.
  template <typename Visit>
  void visit_near(const Eigen::Vector3d& center, double distance, Visit&& visit) const {
    search(0, 0, static_cast<std::int32_t>(order_.size()), center, distance, visit);
  }

 private:
  struct Node {
    std::int32_t axis = 0;
    double middle = 0;  ///< upper bound of the first child's coordinates, lower bound of the second's
  };

  void build(std::size_t k, std::int32_t begin, std::int32_t end) {
    pace_.check();
    if (end - begin <= leaf_size) return;
    Eigen::Vector3d lower = points_[order_[begin]], upper = lower;
    for (std::int32_t at = begin; at < end; ++at) {
      pace_.check();
      lower = lower.cwiseMin(points_[order_[at]]);
      upper = upper.cwiseMax(points_[order_[at]]);
    }
    Node node;
    (upper - lower).maxCoeff(&node.axis);
    const std::int32_t middle_index = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle_index, order_.begin() + end,
                     [&](std::int32_t a, std::int32_t b) { return points_[a][node.axis] < points_[b][node.axis]; });
    node.middle = points_[order_[middle_index]][node.axis];
    if (nodes_.size() <= k) nodes_.resize(k + 1);
    nodes_[k] = node;
    build(2 * k + 1, begin, middle_index);
    build(2 * k + 2, middle_index, end);
  }

  template <typename Visit>
  void search(std::size_t k, std::int32_t begin, std::int32_t end, const Eigen::Vector3d& center, double distance,
              Visit& visit) const {
    if (end - begin <= leaf_size) {
      for (std::int32_t at = begin; at < end; ++at) {
        if ((points_[order_[at]] - center).norm() <= distance) visit(order_[at]);
      }
      return;
    }
    const Node& node = nodes_[k];
    const std::int32_t middle_index = begin + (end - begin) / 2;
    if (center[node.axis] - distance <= node.middle) search(2 * k + 1, begin, middle_index, center, distance, visit);
    if (center[node.axis] + distance >= node.middle) search(2 * k + 2, middle_index, end, center, distance, visit);
  }

  const std::vector<Eigen::Vector3d>& points_;
  std::vector<std::int32_t> order_;
  std::vector<Node> nodes_;
  StopPace pace_;
};

/// Computes first_near_points, with distance_of(i) for point i.
template <typename DistanceOf>
std::vector<std::int32_t> first_near(const std::vector<Eigen::Vector3d>& points, DistanceOf&& distance_of,
                                     const Execution& execution) {
  const PointTree tree(points, execution);
  StopPace pace(execution.cancellation);
  std::vector<std::int32_t> first(points.size(), -1);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(points.size()); ++i) {
    pace.check();
    if (first[i] >= 0) continue;
    first[i] = i;
    tree.visit_near(points[i], distance_of(i), [&](std::int32_t near) {
      if (first[near] < 0 && (points[near] - points[i]).norm() <= distance_of(near)) first[near] = i;
    });
  }
  return first;
}

}  // namespace

std::vector<std::int32_t> first_near_points(const std::vector<Eigen::Vector3d>& points, double distance,
                                            const Execution& execution) {
  return first_near(
      points, [distance](std::int32_t) { return distance; }, execution);
}

std::vector<std::int32_t> first_near_points(const std::vector<Eigen::Vector3d>& points,
                                            const std::vector<double>& distances, const Execution& execution) {
  return first_near(
      points, [&](std::int32_t i) { return distances[i]; }, execution);
}

}  // namespace supple::surface
