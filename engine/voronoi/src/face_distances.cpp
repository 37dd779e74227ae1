#include "face_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::voronoi {
namespace {

/// Relative to a distance: what rounding does to lengths of two arrivals.
constexpr double rounding = 1e-14;

}  // namespace

void FaceDistances::all(Active& active) const {
  active.resize(arrivals_.size());
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = static_cast<std::int32_t>(i);
}

Nearest FaceDistances::prune(const Active& active, const Eigen::Vector2d& point, double radius, Active& kept) const {
  // One pass with the best so far, then one that drops what it kept too early.
  struct Candidate {
    std::int32_t index;
    double length;
  };
  static thread_local std::vector<Candidate> candidates;
  candidates.clear();
  Nearest best{std::numeric_limits<double>::infinity(), -1};
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = arrivals_[i];
    const double length = arrival.length_to(point);
    if (length > best.distance + 2 * radius + rounding * length) continue;
    candidates.push_back({i, length});
    if (length < best.distance) best = {length, arrival.source};
  }
  kept.clear();
  const double limit = best.distance + 2 * radius + rounding * best.distance;
  for (const Candidate& candidate : candidates)
    if (candidate.length <= limit) kept.push_back(candidate.index);
  return best;
}

int FaceDistances::prune_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point, double radius,
                              double tolerance, Active& kept) const {
  kept.clear();
  double best = std::numeric_limits<double>::infinity();
  for (const std::int32_t i : active)
    if (arrivals_[i].source == site) best = std::min(best, arrivals_[i].length_to(point));
  const double limit = best + 2 * radius + rounding * best;
  int others = 0;
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = arrivals_[i];
    if (arrival.source != site || arrival.length_to(point) > limit) continue;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](std::int32_t k) {
      return (arrival.image - arrivals_[k].image).norm() <= tolerance;
    });
    if (!known && !kept.empty()) ++others;
    kept.push_back(i);
  }
  return others;
}

Nearest FaceDistances::nearest(const Active& active, const Eigen::Vector2d& point) const {
  Nearest best{std::numeric_limits<double>::infinity(), -1};
  for (const std::int32_t i : active) {
    const double length = arrivals_[i].length_to(point);
    if (length < best.distance) best = {length, arrivals_[i].source};
  }
  return best;
}

Slope FaceDistances::from_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point) const {
  double least = std::numeric_limits<double>::infinity();
  const surface::FaceArrival* best = nullptr;
  for (const std::int32_t i : active) {
    if (arrivals_[i].source != site) continue;
    const double length = arrivals_[i].length_to(point);
    if (length < least) {
      least = length;
      best = &arrivals_[i];
    }
  }
  if (best == nullptr) return {least, Eigen::Vector2d::Zero()};
  const Eigen::Vector2d way = point - best->turns_at(point);
  const double length = way.norm();
  return {least, length > 0 ? Eigen::Vector2d(way / length) : Eigen::Vector2d::Zero(),
          static_cast<std::int32_t>(best - arrivals_.data())};
}

bool FaceDistances::same_paths(std::int32_t a, const Eigen::Vector2d& at_a, std::int32_t b, const Eigen::Vector2d& at_b,
                               double tolerance) const {
  const Eigen::Vector2d& turn_a = arrivals_[a].turns_at(at_a);
  const Eigen::Vector2d& turn_b = arrivals_[b].turns_at(at_b);
  if ((turn_a - turn_b).norm() > tolerance) return false;
  return std::abs(arrivals_[a].length_to(turn_a) - arrivals_[b].length_to(turn_b)) <= tolerance;
}

bool FaceDistances::of_one_site(const Active& active) const {
  for (const std::int32_t i : active)
    if (arrivals_[i].source != arrivals_[active.front()].source) return false;
  return true;
}

}  // namespace supple::voronoi
