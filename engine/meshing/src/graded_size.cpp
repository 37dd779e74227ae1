#include "graded_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::meshing {
namespace {

/// Sources that are looked through one by one.
constexpr std::int32_t sources_of_a_leaf = 8;

}  // namespace

GradedSize::GradedSize(std::vector<Source> sources, double largest, double grading)
    : sources_(std::move(sources)), largest_(largest), grading_(grading) {
  // Others are never the least.
  std::erase_if(sources_, [&](const Source& source) { return source.length >= largest_; });
  if (sources_.empty()) return;
  branches_.push_back({{}, 0, 0, static_cast<std::int32_t>(sources_.size()), 0});
  divide(0);
}

void GradedSize::divide(std::int32_t branch) {
  const auto number = static_cast<std::size_t>(branch);
  const std::int32_t first = branches_[number].first;
  const std::int32_t end = branches_[number].end;
  double least = std::numeric_limits<double>::infinity();
  Eigen::AlignedBox3d box;
  for (std::int32_t i = first; i < end; ++i) {
    box.extend(sources_[static_cast<std::size_t>(i)].at);
    least = std::min(least, sources_[static_cast<std::size_t>(i)].length);
  }
  branches_[number].box = box;
  branches_[number].least = least;
  if (end - first <= sources_of_a_leaf) return;
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::int32_t middle = first + (end - first) / 2;
  std::nth_element(sources_.begin() + first, sources_.begin() + middle, sources_.begin() + end,
                   [axis](const Source& a, const Source& b) { return a.at[axis] < b.at[axis]; });
  const auto children = static_cast<std::int32_t>(branches_.size());
  branches_[number].children = children;
  branches_.push_back({{}, 0, first, middle, 0});
  branches_.push_back({{}, 0, middle, end, 0});
  divide(children);
  divide(children + 1);
}

double GradedSize::bound(const Branch& branch, const Eigen::Vector3d& point) const {
  return branch.least + grading_ * branch.box.exteriorDistance(point);
}

void GradedSize::search(const Branch& branch, const Eigen::Vector3d& point, double& least) const {
  if (branch.children == 0) {
    for (std::int32_t i = branch.first; i < branch.end; ++i) {
      const Source& source = sources_[static_cast<std::size_t>(i)];
      least = std::min(least, source.length + grading_ * (source.at - point).norm());
    }
    return;
  }
  const Branch* near = &branches_[static_cast<std::size_t>(branch.children)];
  const Branch* far = near + 1;
  if (bound(*far, point) < bound(*near, point)) std::swap(near, far);
  for (const Branch* next : {near, far})
    if (bound(*next, point) < least) search(*next, point, least);
}

double GradedSize::operator()(const Eigen::Vector3d& point) const {
  double least = largest_;
  if (!branches_.empty() && bound(branches_.front(), point) < least) search(branches_.front(), point, least);
  return least;
}

}  // namespace supple::meshing
