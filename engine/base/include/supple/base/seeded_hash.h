#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

namespace supple {

/// A random number of this process. Whoever chooses keys of a hash table does not know it, and so cannot choose many
/// that fall into one bucket, where finding them takes quadratic time.
std::uint64_t hash_seed();

/// A hash of integers, one after the other, for std::unordered_map and the like. It differs from process to process, so
/// nothing may depend on the order in which a table holds its entries. Costs a multiplication of 128 bits for each
/// integer.
class SeededHash {
 public:
  template <std::integral... Integer>
  static std::size_t of(Integer... values) {
    std::uint64_t state = hash_seed();
    ((state = mixed(state ^ static_cast<std::uint64_t>(values))), ...);
    return static_cast<std::size_t>(state);
  }
  template <std::integral Integer>
  std::size_t operator()(Integer value) const {
    return of(value);
  }

 private:
  /// Every bit of the result depends on all bits of the value, in a way that is not linear.
  static std::uint64_t mixed(std::uint64_t value) {
    __extension__ using Wide = unsigned __int128;
    constexpr std::uint64_t odd = 0x9E3779B97F4A7C15U;
    constexpr std::uint64_t other = 0xE7037ED1A0B428DBU;
    const Wide product = static_cast<Wide>(value ^ other) * (odd ^ (value >> 32U));
    return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64U);
  }
};

}  // namespace supple
