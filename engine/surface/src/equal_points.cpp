#include "equal_points.h"

#include <algorithm>
#include <bit>
#include <tuple>

#include "supple/base/stop_pace.h"

namespace supple::surface {
namespace {

struct Entry {
  std::uint64_t hash;
  std::int32_t index;
};

std::uint64_t hash(const Eigen::Vector3d& p) {
  std::uint64_t mixed = 0;
  for (int i = 0; i < 3; ++i) {
    mixed = (mixed ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9e3779b97f4a7c15ULL;  // -0 + 0 is 0
    mixed ^= mixed >> 29;
  }
  return mixed;
}

}  // namespace

std::vector<std::int32_t> first_equal_points(const std::vector<Eigen::Vector3d>& points, const Execution& execution) {
  StopPace pace(execution.cancellation);
  std::vector<std::int32_t> first(points.size());
  std::vector<Entry> entries;
  entries.reserve(points.size());
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(points.size()); ++i) {
    pace.check();
    first[i] = i;
    if (points[i].allFinite()) entries.push_back({hash(points[i]), i});
  }
  // Sorting by hash is fast. Points with the same hash are then sorted by their coordinates, which bounds the cost even
  // if somebody has chosen points whose hashes collide.
  sort_stoppably(entries, execution.cancellation, [](const Entry& a, const Entry& b) { return a.hash < b.hash; });
  const auto coordinates = [&](const Entry& e) {
    const Eigen::Vector3d& p = points[e.index];
    return std::tuple(p[0], p[1], p[2], e.index);
  };
  for (auto group = entries.begin(); group != entries.end();) {
    pace.check();
    const auto end = std::find_if(group, entries.end(), [&](const Entry& e) { return e.hash != group->hash; });
    if (end - group > 1) {
      std::sort(group, end, [&](const Entry& a, const Entry& b) { return coordinates(a) < coordinates(b); });
      for (auto it = group + 1; it != end; ++it) {
        if (points[it->index] == points[(it - 1)->index]) first[it->index] = first[(it - 1)->index];
      }
    }
    group = end;
  }
  return first;
}

}  // namespace supple::surface
