#include "measured_loading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::design {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// At a rupture the stress falls within max_break_points points from at least break_start_fraction of its maximum to
/// below break_end_fraction of it.
constexpr double break_start_fraction = 0.5;
constexpr double break_end_fraction = 0.2;
constexpr std::size_t max_break_points = 4;
/// A sample that the machine took during the fall lies below the previous one by more than this fraction of the maximum
/// stress.
constexpr double min_fall_fraction = 0.1;

std::pair<double, double> range_of(const MeasuredPoints& points) {
  double min_strain = infinity, max_strain = -infinity;
  for (const auto& p : points) {
    min_strain = std::min(min_strain, p.x());
    max_strain = std::max(max_strain, p.x());
  }
  return {min_strain, max_strain};
}

/// Whether the strain of greatest magnitude is negative.
bool is_compression(const MeasuredPoints& points) {
  const auto [min_strain, max_strain] = range_of(points);
  return -min_strain > max_strain;
}

MeasuredPoints mirrored(MeasuredPoints points) {
  for (auto& p : points) p.x() = -p.x();
  return points;
}

double tensile_reversal(const MeasuredPoints& points) {
  double min_strain = infinity, max_strain = -infinity, max_drop = 0;
  for (const auto& p : points) {
    min_strain = std::min(min_strain, p.x());
    max_strain = std::max(max_strain, p.x());
    max_drop = std::max(max_drop, max_strain - p.x());
  }
  return max_strain > min_strain ? max_drop / (max_strain - min_strain) : 0;
}

/// `first_loadings` for tension, or for a compression whose strains were negated.
MeasuredPoints tensile_first_loadings(const MeasuredPoints& points) {
  const auto [min_strain, max_strain] = range_of(points);
  const double threshold = noticeable_fraction * (max_strain - min_strain);
  MeasuredPoints retained, pending;  // `pending` are points below the peak: noise, or the beginning of an unloading
  double peak = -infinity;           // greatest strain of this loading
  double previous_peak = -infinity;  // greatest strain of all earlier loadings
  bool is_loading = true;
  const auto lowest_retained = [&] {
    const auto minimum = std::min_element(retained.rbegin(), retained.rend(),
                                          [](const auto& a, const auto& b) { return a.x() < b.x(); });
    return minimum == retained.rend() ? retained.begin() : minimum.base() - 1;
  };
  for (const auto& p : points) {
    if (!is_loading) {
      if (p.x() <= previous_peak) continue;
      is_loading = true;
    }
    if (p.x() > peak) {
      retained.insert(retained.end(), pending.begin(), pending.end());
      pending.clear();
      retained.push_back(p);
      peak = p.x();
      continue;
    }
    pending.push_back(p);
    if (peak - p.x() <= threshold) continue;
    pending.clear();
    if (previous_peak == -infinity && !retained.empty() && peak - lowest_retained()->x() <= threshold) {
      // No load was applied before this reversal. The test begins here.
      retained.assign(1, p);
      peak = p.x();
      continue;
    }
    is_loading = false;
    previous_peak = peak;
  }
  // Slack of the machine may let the strain decrease at first. The curve then begins at the least strain.
  std::size_t begin = 0;
  for (std::size_t i = 0; i < retained.size() && retained[i].x() < min_strain + 0.5 * (max_strain - min_strain); ++i) {
    if (retained[i].x() <= retained[begin].x()) begin = i;
  }
  retained.erase(retained.begin(), retained.begin() + static_cast<std::ptrdiff_t>(begin));
  return retained;
}

}  // namespace

double reversal(const MeasuredPoints& points) {
  return std::min(tensile_reversal(points), tensile_reversal(mirrored(points)));
}

MeasuredPoints first_loadings(const MeasuredPoints& points) {
  if (!is_compression(points)) return tensile_first_loadings(points);
  return mirrored(tensile_first_loadings(mirrored(points)));
}

std::size_t points_after_rupture(const MeasuredPoints& points) {
  double max_stress = 0;
  for (const auto& p : points) max_stress = std::max(max_stress, std::abs(p.y()));
  std::size_t last_intact = points.size();
  while (last_intact-- > 0) {
    if (std::abs(points[last_intact].y()) >= break_start_fraction * max_stress) break;
  }
  if (max_stress <= 0 || last_intact + 1 >= points.size()) return 0;
  const double direction = is_compression(points) ? -1 : 1;
  bool breaks = false;
  for (std::size_t i = last_intact + 1; i < points.size() && i <= last_intact + max_break_points; ++i) {
    if (direction * (points[i].x() - points[i - 1].x()) < 0) return 0;
    if (std::abs(points[i].y()) < break_end_fraction * max_stress) {
      breaks = true;
      break;
    }
  }
  if (!breaks) return 0;
  while (last_intact > 0 &&
         std::abs(points[last_intact].y()) < std::abs(points[last_intact - 1].y()) - min_fall_fraction * max_stress)
    --last_intact;
  return points.size() - 1 - last_intact;
}

}  // namespace supple::design
