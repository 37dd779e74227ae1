#include "toolpath_statistics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace supple::weave {
namespace {

constexpr double same_height = 1e-4;  ///< difference below which two heights are one, mm

double length_of(const Move& move) {
  double length = 0;
  for (std::size_t i = 1; i < move.points.size(); ++i) length += (move.points[i] - move.points[i - 1]).norm();
  return length;
}

void add_heights(const Move& move, std::vector<double>& heights) {
  for (std::size_t i = 1; i < move.points.size(); ++i) {
    const double z = move.points[i][2];
    if (std::abs(z - move.points[i - 1][2]) > same_height) continue;
    const auto at = std::lower_bound(heights.begin(), heights.end(), z - same_height);
    if (at == heights.end() || *at > z + same_height) heights.insert(at, z);
  }
}

}  // namespace

ToolpathStatistics statistics(const std::vector<Move>& moves, const PrinterProfile& profile) {
  ToolpathStatistics result;
  Eigen::AlignedBox3d box;
  for (const Move& move : moves) {
    const double length = length_of(move);
    result.minutes += length / move.speed;
    if (move.kind == MoveKind::travel) {
      ++result.travels;
      result.travel_length += length;
      result.minutes += 2 * profile.retraction / profile.retraction_speed;
      continue;
    }
    switch (move.kind) {
      case MoveKind::strand:
        result.strand_length += length;
        break;
      case MoveKind::lifted:
        result.lifted_length += length;
        break;
      case MoveKind::channel:
        result.channel_length += length;
        ++result.channels;
        break;
      case MoveKind::priming:
        result.priming_length += length;
        break;
      default:
        result.support_length += length;
    }
    result.extruded_length += length;
    result.filament += length * filament_per_mm(profile, move.area);
    add_heights(move, result.heights);
    if (move.kind != MoveKind::priming)
      for (const Eigen::Vector3d& p : move.points) box.extend(p);
  }
  if (!box.isEmpty()) {
    result.lowest = box.min();
    result.highest = box.max();
  }
  return result;
}

}  // namespace supple::weave
