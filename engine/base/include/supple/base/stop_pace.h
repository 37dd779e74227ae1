#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "supple/base/cancellation.h"

namespace supple {

/// Checks a token at every 16384th call. It serves loops whose bodies take nanoseconds.
class StopPace {
 public:
  explicit StopPace(const CancellationToken& cancellation) : cancellation_(cancellation) {}
  void check() {
    if ((++calls_ & (period - 1)) == 0) cancellation_.throw_if_requested();
  }

 private:
  static constexpr std::uint32_t period = 1 << 14;
  const CancellationToken& cancellation_;
  std::uint32_t calls_ = 0;
};

/// Sorts in parts that are then merged, and checks the token before each of them, so that a stop request waits for some
/// milliseconds. The sort is not stable. O(n log n).
template <class Value, class Less = std::less<>>
void sort_stoppably(std::span<Value> values, const CancellationToken& cancellation, const Less& less = {}) {
  constexpr std::size_t part = 1 << 16;
  const auto at = [values](std::size_t i) {
    return values.begin() + static_cast<std::ptrdiff_t>(std::min(i, values.size()));
  };
  for (std::size_t first = 0; first < values.size(); first += part) {
    cancellation.throw_if_requested();
    std::sort(at(first), at(first + part), less);
  }
  for (std::size_t width = part; width < values.size(); width *= 2)
    for (std::size_t first = 0; first + width < values.size(); first += 2 * width) {
      cancellation.throw_if_requested();
      std::inplace_merge(at(first), at(first + width), at(first + 2 * width), less);
    }
}
template <class Value, class Less = std::less<>>
void sort_stoppably(std::vector<Value>& values, const CancellationToken& cancellation, const Less& less = {}) {
  sort_stoppably(std::span<Value>(values), cancellation, less);
}

}  // namespace supple
