#pragma once

#include <cstdint>
#include <cstring>

#include "supple/base/lanes.h"

// Only inlined functions return vectors of numbers, so that their calling convention does not matter.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"

namespace supple::neural {

/// Vectors of numbers for SIMD instructions, and constants for their exponential function. A Pack has 32 bytes: four
/// doubles or eight floats. A Wide has twice as many. Only inlined functions may pass them by value; see Lanes.
template <class Real>
struct Packs;

template <>
struct Packs<double> {
  using Pack = double __attribute__((vector_size(32)));
  using Wide = double __attribute__((vector_size(64)));
  using Integers = std::int64_t __attribute__((vector_size(32)));
  static constexpr int count = 4;
  static constexpr int mantissa_bits = 52;
  static constexpr std::int64_t exponent_bias = 1023;
  static constexpr double round_to_integer = 0x1.8p52;  ///< adding and subtracting it rounds to an integer
  static constexpr double max_exponent = 708;           ///< limit of |x| up to which exp x is finite and normal
  static constexpr double ln2_high = 0x1.62e42fefa3800p-1;
  static constexpr double ln2_low = 0x1.ef35793c76730p-45;
  /// Taylor coefficients, highest order first. For |r| <= ln 2 / 2, the first omitted term is below a tenth of the last
  /// place.
  static constexpr double exponential[] = {
      1.0 / 6227020800, 1.0 / 479001600, 1.0 / 39916800, 1.0 / 3628800, 1.0 / 362880, 1.0 / 40320, 1.0 / 5040,
      1.0 / 720,        1.0 / 120,       1.0 / 24,       1.0 / 6,       1.0 / 2,      1.0,         1.0};
};

template <>
struct Packs<float> {
  using Pack = float __attribute__((vector_size(32)));
  using Wide = float __attribute__((vector_size(64)));
  using Integers = std::int32_t __attribute__((vector_size(32)));
  static constexpr int count = 8;
  static constexpr int mantissa_bits = 23;
  static constexpr std::int32_t exponent_bias = 127;
  static constexpr float round_to_integer = 0x1.8p23F;
  static constexpr float max_exponent = 87;
  static constexpr float ln2_high = 0x1.62e400p-1F;
  static constexpr float ln2_low = 0x1.7f7d1cp-20F;
  static constexpr float exponential[] = {1.0F / 5040, 1.0F / 720, 1.0F / 120, 1.0F / 24, 1.0F / 6, 0.5F, 1.0F, 1.0F};
};

template <class Real>
using Pack = typename Packs<Real>::Pack;

template <class Real>
SUPPLE_INLINE Pack<Real> load_pack(const Real* from) {
  Pack<Real> value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
template <class Real>
SUPPLE_INLINE void store_pack(Real* to, const Pack<Real>& value) {
  std::memcpy(to, &value, sizeof value);
}
template <class Real>
SUPPLE_INLINE Pack<Real> all_of(Real value) {
  if constexpr (Packs<Real>::count == 4)
    return Pack<Real>{value, value, value, value};
  else
    return Pack<Real>{value, value, value, value, value, value, value, value};
}

/// exp x with an error of about one unit in the last place. Arguments are clamped to +-max_exponent.
template <class Real>
SUPPLE_INLINE Pack<Real> exponential(Pack<Real> x) {
  using P = Packs<Real>;
  x = x > P::max_exponent ? all_of<Real>(P::max_exponent) : x;
  x = x < -P::max_exponent ? all_of<Real>(-P::max_exponent) : x;
  // exp x = 2^n exp r with |r| <= ln 2 / 2. The lowest bits of `shifted` are n.
  const Pack<Real> shifted = x * Real(1.4426950408889634) + P::round_to_integer;
  const Pack<Real> n = shifted - P::round_to_integer;
  const Pack<Real> r = (x - n * P::ln2_high) - n * P::ln2_low;
  Pack<Real> sum = all_of<Real>(P::exponential[0]);
  for (std::size_t i = 1; i < std::size(P::exponential); ++i) sum = sum * r + P::exponential[i];
  typename P::Integers power;
  std::memcpy(&power, &shifted, sizeof power);
  power = (power + P::exponent_bias) << P::mantissa_bits;
  Pack<Real> scale;
  std::memcpy(&scale, &power, sizeof scale);
  return sum * scale;
}

}  // namespace supple::neural

#pragma GCC diagnostic pop
