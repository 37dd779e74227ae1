#include "supple/base/seeded_hash.h"

#include <random>

namespace supple {

std::uint64_t hash_seed() {
  static const std::uint64_t seed = [] {
    std::random_device device;
    return (static_cast<std::uint64_t>(device()) << 32U) ^ device();
  }();
  return seed;
}

}  // namespace supple
