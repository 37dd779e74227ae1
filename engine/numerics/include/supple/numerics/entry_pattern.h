#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// A position in the lower triangle of a symmetric matrix: column << 32 | row. Sorted ones are in compressed column
/// order.
using EntryPosition = std::uint64_t;
/// Stands for an entry that is dropped.
inline constexpr EntryPosition no_position = std::numeric_limits<EntryPosition>::max();

/// The positions of a sparse symmetric matrix and their values. A slot is the number of a value. Slot 0 receives what
/// is dropped.
class EntryPattern {
 public:
  std::size_t size() const { return positions_.size(); }
  /// The slot of a position that the pattern has, or 0 for `no_position`. O(log n).
  std::uint32_t slot_of(EntryPosition position) const {
    return position == no_position ? 0 : static_cast<std::uint32_t>(find(position)) + 1;
  }
  bool has(EntryPosition position) const {
    const std::size_t at = find(position);
    return at < positions_.size() && positions_[at] == position;
  }
  double& value(std::uint32_t slot) { return values_[slot]; }
  double* values() { return values_.data(); }
  /// The values of all positions in order.
  const double* begin() const { return values_.data() + 1; }
  const double* end() const { return values_.data() + values_.size(); }
  void set_zero();

  /// Adds positions that the pattern lacks, in any order, some of them repeatedly. Their values are 0. `slots` become
  /// those of the same positions as before. O(n + added).
  void insert(std::vector<EntryPosition> added, std::vector<std::uint32_t>& slots,
              const CancellationToken& cancellation);
  /// Removes the positions to which no one of `slots` refers, if there are many of them. `slots` become those of the
  /// same positions as before.
  void remove_unfilled(std::vector<std::uint32_t>& slots);
  /// The lower triangle of the n x n matrix.
  SparseMatrix lower(Eigen::Index n) const;

 private:
  /// The index into positions_ of a position or, if it is missing there, of the first one after it.
  std::size_t find(EntryPosition position) const;
  void index_columns();

  std::vector<EntryPosition> positions_;  ///< sorted, without repetition
  /// Index into positions_ of the begin of each column, and the end of the last.
  std::vector<std::size_t> column_begin_{0};
  std::vector<double> values_{0};  ///< values_[1 + i] belongs to positions_[i]
};

}  // namespace supple::numerics
