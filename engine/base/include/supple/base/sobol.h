#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace supple {

/// A scrambled Sobol sequence in up to eight dimensions: points that fill the unit cube evenly at every length.
///
/// The direction numbers are new-joe-kuo-6 [Joe2008]. Nested uniform scrambling [Owen1995] draws each bit's flip from a
/// hash of the seed, the dimension and the bits above it, so that point i needs no other point. Each of the 2^m equal
/// intervals of every axis holds one of the first 2^m points. The same name, seed and index give the same point on
/// every machine.
class SobolSequence {
 public:
  static constexpr int max_dimensions = 8;

  SobolSequence(std::string_view name, std::uint64_t seed);

  /// Coordinates in (0, 1), 32 bits each. O(32 * 8).
  std::array<double, max_dimensions> point(std::uint32_t index) const;

 private:
  std::array<std::uint64_t, max_dimensions> keys_;
};

}  // namespace supple
