#pragma once

#include <cstdint>
#include <string_view>

namespace supple {

/// A named stream of random numbers: the same name and seed give the same numbers on every machine.
///
/// The generator is xoshiro256** [Vigna2018], seeded through splitmix64 from a hash of the name and the seed.
class RandomStream {
 public:
  RandomStream(std::string_view name, std::uint64_t seed);

  std::uint64_t next();
  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in {0, ..., n-1}; n > 0.
  int below(int n);
  /// Standard normal (Box-Muller).
  double normal();

 private:
  std::uint64_t state_[4];
};

}  // namespace supple
