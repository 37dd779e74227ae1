#pragma once

#include <cstring>

/// Functions that are compiled once for AVX2 and once for any x86-64 are written as SUPPLE_INLINE and called from two
/// functions, one with the attribute SUPPLE_AVX2; has_avx2 chooses between them when the program runs.
#define SUPPLE_INLINE inline __attribute__((always_inline))
#if defined(__x86_64__)
#define SUPPLE_AVX2 __attribute__((target("avx2,fma")))
/// The attribute of the few inner loops that gain from vectors of 64 bytes.
#define SUPPLE_AVX512 __attribute__((target("avx512f,avx2,fma")))
#else
#define SUPPLE_AVX2
#define SUPPLE_AVX512
#endif

namespace supple {

/// Four doubles that one instruction computes with. Only SUPPLE_INLINE functions should take or return them by value:
/// calling conventions differ between processors.
using Lanes = double __attribute__((vector_size(4 * sizeof(double))));
inline constexpr int lanes = 4;

// These functions are inlined, so that the calling convention of vectors, of which GCC warns, does not matter.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpsabi"
SUPPLE_INLINE Lanes constant_lanes(double value) { return Lanes{value, value, value, value}; }
SUPPLE_INLINE Lanes load_lanes(const double* from) {
  Lanes value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
SUPPLE_INLINE void store_lanes(double* to, const Lanes& value) { std::memcpy(to, &value, sizeof value); }
#pragma GCC diagnostic pop

/// Whether this machine has the instructions of SUPPLE_AVX2.
#if defined(__x86_64__)
inline const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
inline const bool has_avx512 = has_avx2 && __builtin_cpu_supports("avx512f");
#else
inline constexpr bool has_avx2 = false;
inline constexpr bool has_avx512 = false;
#endif

}  // namespace supple
