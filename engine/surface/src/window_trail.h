#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace supple::surface {

/// The way of a window from its (pseudo-)source, as the turns that it has taken: through each face it went on across
/// the left edge (tail to apex) or across the right one (apex to head). Together with the halfedge at which the window
/// has arrived, this names every edge that it has crossed. One bit for each instead of a whole window: of a search for
/// a far pair nearly every window has a descendant that is still alive when the target is found, so that none of them
/// could be forgotten.
///
/// One number, because windows are read soon after they were written: two halves that are stored one after the other
/// and loaded together would have to wait for memory.
struct Trail {
  std::uint64_t packed;  ///< turns() below, before() above

  /// Of a window that has just left its source.
  static constexpr Trail start() { return after(-1); }
  /// Of a way that no window has found.
  static constexpr Trail none() { return {0}; }
  /// Without turns of its own, behind the full trail of that index.
  static constexpr Trail after(std::int32_t before) {
    return {static_cast<std::uint64_t>(static_cast<std::uint32_t>(before)) << 32 | 1};
  }

  /// The latest turns, the last one in the lowest bit (0 left, 1 right), below a bit that is set.
  std::uint32_t turns() const { return static_cast<std::uint32_t>(packed); }
  /// Index, in the search's list of full trails, of the turns before these; -1 if there are none.
  std::int32_t before() const { return static_cast<std::int32_t>(packed >> 32); }
  bool known() const { return packed != 0; }
  bool at_start() const { return packed == start().packed; }
  /// No room for another turn.
  bool full() const { return turns() >> 31 != 0; }
  /// Of a trail that is not full: doubles the turns.
  Trail after_turn(bool right) const { return {packed + turns() + static_cast<std::uint64_t>(right)}; }
  /// Number of turns, without those before. Of a trail that is known.
  std::size_t turns_here() const { return static_cast<std::size_t>(std::bit_width(turns())) - 1; }
};

}  // namespace supple::surface
