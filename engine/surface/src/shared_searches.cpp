#include "shared_searches.h"

#include <algorithm>
#include <numeric>

#include "supple/base/parallel_tasks.h"

namespace supple::surface {
namespace {

/// Cost of one search for all points of a disk, divided by that of a search for one point on its border. Both are
/// proportional to the squared radius.
constexpr double disk_cost_ratio = 12;
/// Maximum number of targets of one search. More targets are divided, so that several threads work for one source.
constexpr std::size_t max_targets = 256;

bool same_point(const SurfacePoint& a, const SurfacePoint& b) {
  return a.face == b.face && a.barycentric == b.barycentric;
}

bool before(const SurfacePoint& a, const SurfacePoint& b) {
  if (a.face != b.face) return a.face < b.face;
  return std::ranges::lexicographical_compare(a.barycentric, b.barycentric);
}

struct Target {
  std::size_t pair;
  double squared_distance;  ///< square of the straight distance from the source
};

/// Number of targets, which are sorted by distance, that should share a search for the least total work.
std::size_t shared_target_count(const std::vector<Target>& targets) {
  double work_alone = 0;
  for (const Target& target : targets) work_alone += target.squared_distance;
  double min_work = work_alone;
  std::size_t best = 0;
  for (std::size_t k = 0; k < targets.size(); ++k) {
    work_alone -= targets[k].squared_distance;
    const double work = disk_cost_ratio * targets[k].squared_distance + work_alone;
    if (work >= min_work) continue;
    min_work = work;
    best = k + 1;
  }
  return best;
}

}  // namespace

std::vector<std::vector<std::size_t>> shared_searches(const TriangleMesh& mesh, std::span<const PointPair> pairs) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t i, std::size_t j) { return before(pairs[i].from, pairs[j].from); });
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t begin = 0; begin < order.size();) {
    const SurfacePoint& from = pairs[order[begin]].from;
    const Eigen::Vector3d source = position(mesh, from);
    std::vector<Target> targets;
    std::size_t end = begin;
    for (; end < order.size() && same_point(pairs[order[end]].from, from); ++end) {
      const PointPair& pair = pairs[order[end]];
      const bool connected = mesh.component(index(pair.from.face)) == mesh.component(index(pair.to.face));
      if (pair.known_path || !connected)
        groups.push_back({order[end]});
      else
        targets.push_back({order[end], (position(mesh, pair.to) - source).squaredNorm()});
    }
    begin = end;
    std::ranges::stable_sort(targets, {}, &Target::squared_distance);
    const std::size_t together = shared_target_count(targets);
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const bool joins = k > 0 && k < together && groups.back().size() < max_targets;
      if (!joins) groups.emplace_back();
      groups.back().push_back(targets[k].pair);
    }
  }
  return groups;
}

void GeodesicSolver::pairs(std::span<const PointPair> pairs, std::span<Geodesic> results,
                           const GeodesicOptions& options, const Execution& execution) const {
  const auto groups = shared_searches(mesh(), pairs);
  const auto search = [&](const std::vector<std::size_t>& group, const Execution& own) {
    const PointPair& first = pairs[group.front()];
    if (group.size() == 1) {
      results[group.front()] = geodesic(first.from, first.to, options, own, {.known_path = first.known_path});
      return;
    }
    std::vector<SurfacePoint> targets;
    targets.reserve(group.size());
    for (const std::size_t pair : group) targets.push_back(pairs[pair].to);
    std::vector<Geodesic> found = geodesics(first.from, targets, options, own);
    for (std::size_t k = 0; k < group.size(); ++k) results[group[k]] = std::move(found[k]);
  };
  // One search reports its own progress.
  if (groups.size() == 1) return search(groups.front(), execution);
  parallel_tasks(static_cast<int>(groups.size()), execution, "search",
                 [&](int g, const Execution& own) { search(groups[static_cast<std::size_t>(g)], own); });
}

}  // namespace supple::surface
