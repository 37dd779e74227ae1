#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace supple::surface {

/// The edges that the paths of a window have crossed since their (pseudo-)source, as one turn for each face: left if
/// they left the face across the edge from tail to apex, right if across the edge from apex to head. The turns and the
/// halfedge at which the window has arrived determine all of these edges.
///
/// One bit for each face takes the place of a link to the previous window. In a search for a far pair, nearly every
/// window has a descendant that is still pending when the target is found, so that no linked window could be freed.
///
/// Turns and index share one number, because windows are read soon after they were written: a single load of two halves
/// that were stored separately would have to wait for memory.
struct Trail {
  std::uint64_t packed;  ///< turns() in the lower half, earlier() in the upper half

  /// The trail of a window that has just left its source.
  static constexpr Trail start() { return after(-1); }
  /// A placeholder for a path that no window has found.
  static constexpr Trail none() { return {0}; }
  /// A trail without turns of its own that continues the full trail of that index.
  static constexpr Trail after(std::int32_t earlier) {
    return {static_cast<std::uint64_t>(static_cast<std::uint32_t>(earlier)) << 32 | 1};
  }

  /// The latest turns, the last one in the lowest bit (0 left, 1 right). A bit that is set marks their end.
  std::uint32_t turns() const { return static_cast<std::uint32_t>(packed); }
  /// Index, in the search's list of full trails, of the turns before these; -1 if there are none.
  std::int32_t earlier() const { return static_cast<std::int32_t>(packed >> 32); }
  bool known() const { return packed != 0; }
  bool at_start() const { return packed == start().packed; }
  /// Whether there is no room for another turn.
  bool full() const { return turns() >> 31 != 0; }
  /// The trail with one more turn. This one must not be full.
  Trail after_turn(bool right) const { return {packed + turns() + static_cast<std::uint64_t>(right)}; }
  /// Number of turns, without those of earlier trails. The trail must be known.
  std::size_t turn_count() const { return static_cast<std::size_t>(std::bit_width(turns())) - 1; }
};

}  // namespace supple::surface
