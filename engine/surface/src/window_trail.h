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
struct Trail {
  /// The latest turns, the last one in the lowest bit (0 left, 1 right), below a bit that is set.
  std::uint32_t turns;
  /// Index, in the search's list of full trails, of the turns before these; -1 if there are none.
  std::int32_t before;

  /// Of a window that has just left its source.
  static constexpr Trail start() { return {1, -1}; }
  /// Of a way that no window has found.
  static constexpr Trail none() { return {0, -1}; }

  bool known() const { return turns != 0; }
  bool at_start() const { return turns == 1 && before < 0; }
  /// No room for another turn.
  bool full() const { return turns >> 31 != 0; }
  /// Number of turns, without those before. Of a trail that is known.
  std::size_t turns_here() const { return static_cast<std::size_t>(std::bit_width(turns)) - 1; }
  Trail after_turn(bool right) const { return {turns << 1 | static_cast<std::uint32_t>(right), before}; }
};

}  // namespace supple::surface
