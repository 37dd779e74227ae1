#include "measured_loading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::design {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Fractions of the greatest stress between which it falls at a break, and within how many points.
constexpr double before_break = 0.5;
constexpr double after_break = 0.2;
constexpr std::size_t break_points = 4;
/// A sample in the middle of the fall lies below the one before by more than this fraction of the greatest stress.
constexpr double falling = 0.1;

std::pair<double, double> range_of(const MeasuredPoints& points) {
  double least = infinity, greatest = -infinity;
  for (const auto& p : points) {
    least = std::min(least, p.x());
    greatest = std::max(greatest, p.x());
  }
  return {least, greatest};
}

/// Whether the strain of greatest size is a compression.
bool is_compression(const MeasuredPoints& points) {
  const auto [least, greatest] = range_of(points);
  return -least > greatest;
}

MeasuredPoints mirrored(MeasuredPoints points) {
  for (auto& p : points) p.x() = -p.x();
  return points;
}

double turning_back_upwards(const MeasuredPoints& points) {
  double least = infinity, greatest = -infinity, back = 0;
  for (const auto& p : points) {
    least = std::min(least, p.x());
    greatest = std::max(greatest, p.x());
    back = std::max(back, greatest - p.x());
  }
  return greatest > least ? back / (greatest - least) : 0;
}

/// Of tension, or of a compression that was mirrored.
MeasuredPoints first_loadings_upwards(const MeasuredPoints& points) {
  const auto [least, greatest] = range_of(points);
  const double threshold = noticeable_fraction * (greatest - least);
  MeasuredPoints kept, pending;  // pending: behind the greatest strain so far, whether it turns back or shakes
  double peak = -infinity;       // greatest strain of this loading
  double reached = -infinity;    // greatest strain of all loadings before
  bool loads = true;
  const auto lowest_first = [&] {
    const auto lowest =
        std::min_element(kept.rbegin(), kept.rend(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
    return lowest == kept.rend() ? kept.begin() : lowest.base() - 1;
  };
  for (const auto& p : points) {
    if (!loads) {
      if (p.x() <= reached) continue;
      loads = true;
    }
    if (p.x() > peak) {
      kept.insert(kept.end(), pending.begin(), pending.end());
      pending.clear();
      kept.push_back(p);
      peak = p.x();
      continue;
    }
    pending.push_back(p);
    if (peak - p.x() <= threshold) continue;
    pending.clear();
    if (reached == -infinity && !kept.empty() && peak - lowest_first()->x() <= threshold) {
      // Nothing was loaded before the strain turned back: the test begins here.
      kept.assign(1, p);
      peak = p.x();
      continue;
    }
    loads = false;
    reached = peak;
  }
  // Where the slack of the machine made the strain fall at first, the curve begins where it was least.
  std::size_t begin = 0;
  for (std::size_t i = 0; i < kept.size() && kept[i].x() < least + 0.5 * (greatest - least); ++i) {
    if (kept[i].x() <= kept[begin].x()) begin = i;
  }
  kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(begin));
  return kept;
}

}  // namespace

double turning_back(const MeasuredPoints& points) {
  return std::min(turning_back_upwards(points), turning_back_upwards(mirrored(points)));
}

MeasuredPoints first_loadings(const MeasuredPoints& points) {
  if (!is_compression(points)) return first_loadings_upwards(points);
  return mirrored(first_loadings_upwards(mirrored(points)));
}

std::size_t points_after_rupture(const MeasuredPoints& points) {
  double greatest = 0;
  for (const auto& p : points) greatest = std::max(greatest, std::abs(p.y()));
  std::size_t last = points.size();
  while (last-- > 0) {
    if (std::abs(points[last].y()) >= before_break * greatest) break;
  }
  if (greatest <= 0 || last + 1 >= points.size()) return 0;
  const double direction = is_compression(points) ? -1 : 1;
  bool breaks = false;
  for (std::size_t i = last + 1; i < points.size() && i <= last + break_points; ++i) {
    if (direction * (points[i].x() - points[i - 1].x()) < 0) return 0;
    if (std::abs(points[i].y()) < after_break * greatest) {
      breaks = true;
      break;
    }
  }
  if (!breaks) return 0;
  while (last > 0 && std::abs(points[last].y()) < std::abs(points[last - 1].y()) - falling * greatest) --last;
  return points.size() - 1 - last;
}

}  // namespace supple::design
