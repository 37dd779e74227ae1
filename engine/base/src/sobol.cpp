#include "supple/base/sobol.h"

#include <bit>

#include "supple/base/random.h"

namespace supple {
namespace {

constexpr int bits = 32;

/// Degree and inner coefficients of a primitive polynomial, and the first direction numbers m_1 .. m_degree.
struct Polynomial {
  int degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 5> initial;
};

/// Dimensions 2 to 8 of new-joe-kuo-6.21201 [Joe2008]; the first dimension is van der Corput's sequence.
constexpr std::array<Polynomial, SobolSequence::max_dimensions - 1> polynomials{{{1, 0, {1}},
                                                                                 {2, 1, {1, 3}},
                                                                                 {3, 1, {1, 3, 1}},
                                                                                 {3, 2, {1, 1, 1}},
                                                                                 {4, 1, {1, 1, 3, 3}},
                                                                                 {4, 4, {1, 3, 5, 13}},
                                                                                 {5, 2, {1, 1, 5, 5, 17}}}};

using Directions = std::array<std::uint32_t, bits>;

constexpr Directions directions(const Polynomial& polynomial) {
  Directions v{};
  const int s = polynomial.degree;
  for (int i = 0; i < s; ++i)
    v[static_cast<std::size_t>(i)] = polynomial.initial[static_cast<std::size_t>(i)] << (bits - 1 - i);
  for (int i = s; i < bits; ++i) {
    std::uint32_t value = v[static_cast<std::size_t>(i - s)];
    value ^= value >> s;
    for (int k = 1; k < s; ++k)
      if (((polynomial.coefficients >> (s - 1 - k)) & 1U) != 0) value ^= v[static_cast<std::size_t>(i - k)];
    v[static_cast<std::size_t>(i)] = value;
  }
  return v;
}

constexpr std::array<Directions, SobolSequence::max_dimensions> all_directions() {
  std::array<Directions, SobolSequence::max_dimensions> all{};
  for (int i = 0; i < bits; ++i) all[0][static_cast<std::size_t>(i)] = 1U << (bits - 1 - i);
  for (std::size_t d = 1; d < all.size(); ++d) all[d] = directions(polynomials[d - 1]);
  return all;
}

/// The finalizer of splitmix64: every bit of the result depends on every bit of the argument.
std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::uint32_t scrambled(std::uint32_t value, std::uint64_t key) {
  std::uint32_t result = 0;
  // The bits above bit b decide whether it is flipped. A leading one distinguishes prefixes of different lengths.
  for (int b = 0; b < bits; ++b) {
    const std::uint64_t prefix = (std::uint64_t{1} << b) | (static_cast<std::uint64_t>(value) >> (bits - b));
    const std::uint32_t flip = static_cast<std::uint32_t>(mixed(key + prefix * 0x9e3779b97f4a7c15ULL) >> 63);
    const std::uint32_t bit = (value >> (bits - 1 - b)) & 1U;
    result = (result << 1) | (bit ^ flip);
  }
  return result;
}

}  // namespace

SobolSequence::SobolSequence(std::string_view name, std::uint64_t seed) : keys_{} {
  RandomStream stream(name, seed);
  for (std::uint64_t& key : keys_) key = stream.next();
}

std::array<double, SobolSequence::max_dimensions> SobolSequence::point(std::uint32_t index) const {
  static constexpr auto all = all_directions();
  std::array<double, max_dimensions> coordinates{};
  for (std::size_t d = 0; d < coordinates.size(); ++d) {
    std::uint32_t value = 0;
    for (std::uint32_t rest = index; rest != 0; rest &= rest - 1)
      value ^= all[d][static_cast<std::size_t>(std::countr_zero(rest))];
    coordinates[d] = (scrambled(value, keys_[d]) + 0.5) * 0x1.0p-32;
  }
  return coordinates;
}

}  // namespace supple
