#include "face_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::voronoi {
namespace {

/// Relative to a distance: rounding error of the lengths of two arrivals.
constexpr double rounding = 1e-14;

/// Whether even a straight path from the image would be no shorter than `length`. Most arrivals are excluded by this
/// cheap test, without a square root.
bool is_no_shorter(const surface::FaceArrival& arrival, const Eigen::Vector2d& point, double length) {
  const double straight = length - arrival.sigma;
  return straight <= 0 || (point - arrival.image).squaredNorm() > straight * straight * (1 + rounding);
}

}  // namespace

void FaceDistances::all(Active& active) const {
  active.resize(arrivals_.size());
  for (std::size_t i = 0; i < active.size(); ++i) active[i] = static_cast<std::int32_t>(i);
}

bool FaceDistances::is_straight_within(const surface::FaceArrival& arrival, const Eigen::Vector2d& point,
                                       double radius) {
  if (arrival.everywhere) return true;
  const Eigen::Vector2d to = point - arrival.image;
  const auto inside = [&](const Eigen::Vector2d& end, double side) {
    const Eigen::Vector2d edge = end - arrival.image;
    return side * (edge.x() * to.y() - edge.y() * to.x()) > radius * edge.norm();
  };
  return inside(arrival.begin, -1) && inside(arrival.end, 1);
}

Nearest FaceDistances::prune(const Active& active, const Eigen::Vector2d& point, double radius,
                             Active& remaining) const {
  charge(active.size());
  // The first pass compares with the shortest length so far. The second pass drops what it retained too early.
  struct Candidate {
    std::int32_t index;
    double length;
  };
  static thread_local std::vector<Candidate> candidates;
  candidates.clear();
  Nearest best{std::numeric_limits<double>::infinity(), -1};
  std::int32_t nearest = -1;
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = arrivals_[i];
    if (is_no_shorter(arrival, point, (best.distance + 2 * radius) * (1 + 2 * rounding))) continue;
    const double length = arrival.length_to(point);
    if (length > best.distance + 2 * radius + rounding * length) continue;
    candidates.push_back({i, length});
    if (length < best.distance) {
      best = {length, arrival.source};
      nearest = i;
    }
  }
  remaining.clear();
  if (nearest < 0) return best;
  const double slack = rounding * best.distance;
  const surface::FaceArrival& shortest = arrivals_[nearest];
  const bool has_alternatives = candidates.size() > 1 && is_straight_within(shortest, point, radius);
  const double to_shortest = best.distance - shortest.sigma;
  for (const Candidate& candidate : candidates) {
    if (candidate.length > best.distance + 2 * radius + slack) continue;
    if (has_alternatives && candidate.index != nearest) {
      // No path of the other arrival is shorter than the straight line from its image. The gradients of |x - S| and |x
      // - T|, S and T the images, differ by at most 2 |S - T| / (|x - S| + |x - T|). This bounds how fast one length
      // gains on the other.
      const surface::FaceArrival& other = arrivals_[candidate.index];
      const double to_other = (point - other.image).norm();
      const double min_sum = to_shortest + to_other - 2 * radius;
      const double gain = other.sigma + to_other - best.distance - slack;
      if (gain > 0 && min_sum > 0 && gain * min_sum > 2 * radius * (other.image - shortest.image).norm()) continue;
    }
    remaining.push_back(candidate.index);
  }
  return best;
}

int FaceDistances::prune_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point, double radius,
                              double tolerance, Active& remaining) const {
  charge(active.size());
  remaining.clear();
  double best = std::numeric_limits<double>::infinity();
  for (const std::int32_t i : active)
    if (arrivals_[i].source == site && !is_no_shorter(arrivals_[i], point, best))
      best = std::min(best, arrivals_[i].length_to(point));
  const double limit = best + 2 * radius + rounding * best;
  int others = 0;
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = arrivals_[i];
    if (arrival.source != site || is_no_shorter(arrival, point, limit * (1 + rounding)) ||
        arrival.length_to(point) > limit)
      continue;
    const bool has_image = std::any_of(remaining.begin(), remaining.end(), [&](std::int32_t k) {
      return (arrival.image - arrivals_[k].image).norm() <= tolerance;
    });
    if (!has_image && !remaining.empty()) ++others;
    remaining.push_back(i);
  }
  return others;
}

Nearest FaceDistances::nearest(const Active& active, const Eigen::Vector2d& point) const {
  charge(active.size());
  Nearest best{std::numeric_limits<double>::infinity(), -1};
  for (const std::int32_t i : active) {
    if (is_no_shorter(arrivals_[i], point, best.distance)) continue;
    const double length = arrivals_[i].length_to(point);
    if (length < best.distance) best = {length, arrivals_[i].source};
  }
  return best;
}

SiteDistance FaceDistances::from_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point) const {
  charge(active.size());
  double least = std::numeric_limits<double>::infinity();
  const surface::FaceArrival* best = nullptr;
  for (const std::int32_t i : active) {
    if (arrivals_[i].source != site || is_no_shorter(arrivals_[i], point, least)) continue;
    const double length = arrivals_[i].length_to(point);
    if (length < least) {
      least = length;
      best = &arrivals_[i];
    }
  }
  if (best == nullptr) return {least, Eigen::Vector2d::Zero()};
  const Eigen::Vector2d offset = point - best->turns_at(point);
  const double length = offset.norm();
  return {least, length > 0 ? Eigen::Vector2d(offset / length) : Eigen::Vector2d::Zero(),
          static_cast<std::int32_t>(best - arrivals_.data())};
}

bool FaceDistances::is_distance(const Active& active, std::int32_t site, const Eigen::Vector2d& point, double length,
                                double tolerance) const {
  charge(active.size());
  bool reached = false;
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = arrivals_[i];
    if (arrival.source != site || is_no_shorter(arrival, point, length + tolerance)) continue;
    const double own = arrival.length_to(point);
    if (own < length - tolerance) return false;
    reached = reached || own <= length + tolerance;
  }
  return reached;
}

bool FaceDistances::are_of_one_site(const Active& active) const {
  for (const std::int32_t i : active)
    if (arrivals_[i].source != arrivals_[active.front()].source) return false;
  return true;
}

}  // namespace supple::voronoi
