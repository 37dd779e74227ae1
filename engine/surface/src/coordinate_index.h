#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <vector>

namespace supple::surface {

/// Finds equal points. Coordinates are compared exactly, with 0 and -0 equal. Finite points only.
class CoordinateIndex {
 public:
  /// An index over `points`, which must outlive it and may grow to `capacity` points.
  CoordinateIndex(const std::vector<Eigen::Vector3d>& points, std::size_t capacity)
      : points_(points), slots_(std::bit_ceil(2 * capacity + 2), -1) {}

  /// The point that equals points[i] and was added first, or i itself after adding it. O(1) on average.
  std::int32_t find_or_add(std::int32_t i) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash(points_[i]) & mask;
    while (slots_[slot] >= 0) {
      if (points_[slots_[slot]] == points_[i]) return slots_[slot];
      slot = (slot + 1) & mask;
    }
    return slots_[slot] = i;
  }

 private:
  static std::size_t hash(const Eigen::Vector3d& p) {
    std::uint64_t mixed = 0;
    for (int i = 0; i < 3; ++i) {
      mixed = (mixed ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9e3779b97f4a7c15ULL;  // -0 + 0 is 0
      mixed ^= mixed >> 29;
    }
    return static_cast<std::size_t>(mixed * 0xbf58476d1ce4e5b9ULL >> 16);
  }

  const std::vector<Eigen::Vector3d>& points_;
  std::vector<std::int32_t> slots_;
};

}  // namespace supple::surface
