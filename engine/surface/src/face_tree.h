#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "supple/base/execution.h"
#include "supple/base/stop_pace.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// The bounding boxes of a mesh's faces in a balanced tree. Node k contains a range [begin, end) of `order_`, its
/// children 2 k + 1 and 2 k + 2 one half each. Building takes O(n log n); memory is 28 to 52 bytes per face.
class FaceTree {
 public:
  using Box = Eigen::AlignedBox3d;

  FaceTree(const std::vector<Eigen::Vector3d>& positions, const std::vector<Triangle>& faces,
           const Execution& execution = {})
      : positions_(positions), faces_(faces), order_(faces.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    StopPace pace(execution.cancellation);
    if (!order_.empty()) build(0, 0, static_cast<std::int32_t>(order_.size()), pace);
  }

  /// Calls visit(f) for each face whose box intersects the given one.
  template <typename Visit>
  void visit_overlaps(const Box& box, Visit&& visit) const {
    if (!order_.empty()) search_box(0, 0, static_cast<std::int32_t>(order_.size()), box, visit);
  }

  /// Calls visit(f, limit) for all faces of each leaf whose box is at most sqrt(limit) from p. The nearer child of each
  /// node comes first. `limit`, a squared distance, is infinite at first, and `visit` may lower it.
  template <typename Visit>
  void visit_nearest(const Eigen::Vector3d& p, Visit&& visit) const {
    double limit = std::numeric_limits<double>::infinity();
    if (!order_.empty()) search_point(0, 0, static_cast<std::int32_t>(order_.size()), p, limit, visit);
  }

  Box box_of(std::int32_t f) const {
    const Triangle& face = faces_[f];
    Box box(positions_[face[0]]);
    return box.extend(positions_[face[1]]).extend(positions_[face[2]]);
  }

 private:
  static constexpr std::int32_t leaf_size = 4;

  void build(std::size_t k, std::int32_t begin, std::int32_t end, StopPace& pace) {
    Box box;
    for (std::int32_t i = begin; i < end; ++i) {
      pace.check();
      box.extend(box_of(order_[i]));
    }
    if (boxes_.size() <= k) boxes_.resize(k + 1);
    boxes_[k] = box;
    if (end - begin <= leaf_size) return;
    Eigen::Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto triple_centroid = [&](std::int32_t f) {
      const Triangle& face = faces_[f];
      return positions_[face[0]][axis] + positions_[face[1]][axis] + positions_[face[2]][axis];
    };
    const std::int32_t half = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end,
                     [&](std::int32_t a, std::int32_t b) { return triple_centroid(a) < triple_centroid(b); });
    build(2 * k + 1, begin, half, pace);
    build(2 * k + 2, half, end, pace);
  }

  template <typename Visit>
  void search_box(std::size_t k, std::int32_t begin, std::int32_t end, const Box& box, Visit& visit) const {
    if (!boxes_[k].intersects(box)) return;
    if (end - begin <= leaf_size) {
      for (std::int32_t i = begin; i < end; ++i)
        if (box_of(order_[i]).intersects(box)) visit(order_[i]);
      return;
    }
    const std::int32_t half = begin + (end - begin) / 2;
    search_box(2 * k + 1, begin, half, box, visit);
    search_box(2 * k + 2, half, end, box, visit);
  }

  template <typename Visit>
  void search_point(std::size_t k, std::int32_t begin, std::int32_t end, const Eigen::Vector3d& p, double& limit,
                    Visit& visit) const {
    if (end - begin <= leaf_size) {
      for (std::int32_t i = begin; i < end; ++i) visit(order_[i], limit);
      return;
    }
    const std::int32_t half = begin + (end - begin) / 2;
    const double first = boxes_[2 * k + 1].squaredExteriorDistance(p);
    const double second = boxes_[2 * k + 2].squaredExteriorDistance(p);
    const auto search_first = [&] {
      if (first <= limit) search_point(2 * k + 1, begin, half, p, limit, visit);
    };
    if (first <= second) search_first();
    if (second <= limit) search_point(2 * k + 2, half, end, p, limit, visit);
    if (first > second) search_first();
  }

  const std::vector<Eigen::Vector3d>& positions_;
  const std::vector<Triangle>& faces_;
  std::vector<std::int32_t> order_;
  std::vector<Box> boxes_;
};

}  // namespace supple::surface
