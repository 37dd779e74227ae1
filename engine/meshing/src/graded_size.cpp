#include "graded_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::meshing {
namespace {

/// Largest number of sources in a leaf of the tree.
constexpr std::int32_t max_leaf_sources = 8;

}  // namespace

GradedSize::GradedSize(std::vector<Source> sources, double max_length, double grading)
    : sources_(std::move(sources)), max_length_(max_length), grading_(grading) {
  // Sources of greater length never give the minimum.
  std::erase_if(sources_, [&](const Source& source) { return source.length >= max_length_; });
  if (sources_.empty()) return;
  nodes_.push_back({{}, 0, 0, static_cast<std::int32_t>(sources_.size()), 0});
  divide(0);
}

void GradedSize::divide(std::int32_t node) {
  const auto number = static_cast<std::size_t>(node);
  const std::int32_t first = nodes_[number].first;
  const std::int32_t end = nodes_[number].end;
  double min_length = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox3d box;
  for (std::int32_t i = first; i < end; ++i) {
    box.extend(sources_[static_cast<std::size_t>(i)].position);
    min_length = std::min(min_length, sources_[static_cast<std::size_t>(i)].length);
  }
  nodes_[number].box = box;
  nodes_[number].min_length = min_length;
  if (end - first <= max_leaf_sources) return;
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::int32_t middle = first + (end - first) / 2;
  std::nth_element(sources_.begin() + first, sources_.begin() + middle, sources_.begin() + end,
                   [axis](const Source& a, const Source& b) { return a.position[axis] < b.position[axis]; });
  const auto children = static_cast<std::int32_t>(nodes_.size());
  nodes_[number].children = children;
  nodes_.push_back({{}, 0, first, middle, 0});
  nodes_.push_back({{}, 0, middle, end, 0});
  divide(children);
  divide(children + 1);
}

double GradedSize::lower_bound(const Node& node, const Eigen::Vector3d& point) const {
  return node.min_length + grading_ * node.box.exteriorDistance(point);
}

void GradedSize::search(const Node& node, const Eigen::Vector3d& point, double& min_length) const {
  if (node.children == 0) {
    for (std::int32_t i = node.first; i < node.end; ++i) {
      const Source& source = sources_[static_cast<std::size_t>(i)];
      min_length = std::min(min_length, source.length + grading_ * (source.position - point).norm());
    }
    return;
  }
  const Node* near = &nodes_[static_cast<std::size_t>(node.children)];
  const Node* far = near + 1;
  if (lower_bound(*far, point) < lower_bound(*near, point)) std::swap(near, far);
  for (const Node* next : {near, far})
    if (lower_bound(*next, point) < min_length) search(*next, point, min_length);
}

double GradedSize::operator()(const Eigen::Vector3d& point) const {
  double min_length = max_length_;
  if (!nodes_.empty() && lower_bound(nodes_.front(), point) < min_length) search(nodes_.front(), point, min_length);
  return min_length;
}

}  // namespace supple::meshing
