#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/numerics/entry_pattern.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// The unknown of each degree of freedom, in ascending order; -1 for a fixed one.
using Numbering = std::vector<std::int32_t>;

/// Collects the entries of a symmetric matrix of second derivatives while terms add them. Entries (i, j) and (j, i) are
/// the same position. Each entry is given once, and entries of the same position add up.
///
/// Terms add the same positions in the same order at every state, or nearly so. The first assembly sorts them. Later
/// ones recognize the sequence and add each value directly to its position. A block that replaces another one, e.g.
/// because a geodesic crosses other faces, costs its own entries alone. Where single entries or the number of blocks
/// change, all that follows is looked up, so such terms are best added last. Positions stay in the pattern, so that
/// factorizations keep their symbolic analysis while contacts come and go. They are removed only when the pattern grows
/// anyway and many of them are empty.
class HessianEntries {
 public:
  /// Degrees of freedom from `border` on are few and couple with all others; they are stored as dense columns. No
  /// degree of freedom is fixed.
  explicit HessianEntries(Eigen::Index border = std::numeric_limits<std::int32_t>::max());
  /// Degrees of freedom beyond the numbering form the border. Entries of fixed ones are dropped. Rows and columns of
  /// the core are numbered by unknowns.
  explicit HessianEntries(Numbering numbering);

  void add(Eigen::Index i, Eigen::Index j, double value) {
    const auto [low, high] = i < j ? std::pair(i, j) : std::pair(j, i);
    if (high >= border_) {
      require_border(high);
      border_columns_(low, high - border_) += value;
      return;
    }
    const EntryPosition position = position_of(low, high);
    if (position != no_position) add_at(position, value);
  }

  /// Whether entries of this degree of freedom are dropped because it is fixed.
  bool drops(Eigen::Index i) const { return i < border_ && !numbering_.empty() && numbering_[index(i)] < 0; }

  /// The number of entries in the lower triangle of an element's matrix.
  static constexpr std::size_t entries_of(std::size_t rows) { return rows * (rows + 1) / 2; }

  /// Adds an element's matrix, several times as fast as entry by entry. `rows` are its degrees of freedom, all below
  /// the border. lower[k (k + 1) / 2 + l] is the entry of rows[k] and rows[l], l <= k. If two rows are equal, it stands
  /// for both orders.
  template <std::size_t size>
  void add_block(const std::array<std::int32_t, size>& rows, const double* lower) {
    add_core_block(rows.data(), size, lower);
  }

  /// The same for any number of rows. They differ from each other, and those of the border come last.
  void add_block(std::span<const std::int32_t> rows, const double* lower);

  /// Adds the entries of `row` with first, first + 1, ..., which are all greater than `row`. It is fast if the border
  /// begins at `first`.
  template <int count>
  void add_row(Eigen::Index row, Eigen::Index first, const double* values) {
    if (first == border_) {
      require_border(border_ + count - 1);
      for (int k = 0; k < count; ++k) border_columns_(row, k) += values[k];
    } else {
      for (int k = 0; k < count; ++k) add(row, first + k, values[k]);
    }
  }

  /// Sets the token that is checked while positions are sorted; it must be valid until the next call. Null means none.
  void stop_with(const CancellationToken* cancellation) { cancellation_ = cancellation; }

  /// Sets the values to zero and returns to the start of the sequence.
  void clear();

  /// The n x n matrix of all unknowns, both triangles filled. There must be no border.
  SparseMatrix matrix(Eigen::Index n);

  /// The same matrix in parts, for n degrees of freedom. The core and the border's rows belong to the unknowns only.
  void assemble(Eigen::Index n, BorderedMatrix& into);

 private:
  struct Block {
    std::size_t cursor;  ///< index into sequence_ of its first entry
    std::size_t first;   ///< index into block_rows_ of its first row
    std::size_t size;
  };
  /// A block that was added where another one was expected. Its rows and entries are the next ones in replaced_rows_
  /// and replaced_entries_.
  struct ReplacedBlock {
    std::size_t block;  ///< index into blocks_ of the block that was expected
    std::size_t size;
  };
  using Entry = std::pair<EntryPosition, double>;

  static std::size_t index(Eigen::Index i) { return static_cast<std::size_t>(i); }
  /// The position of an entry with low <= high below the border; `no_position` if one of the two is fixed.
  EntryPosition position_of(Eigen::Index low, Eigen::Index high) const {
    if (numbering_.empty()) return static_cast<EntryPosition>(low) << 32 | static_cast<EntryPosition>(high);
    const std::int32_t column = numbering_[index(low)];
    const std::int32_t row = numbering_[index(high)];
    if (column < 0 || row < 0) return no_position;
    return static_cast<EntryPosition>(column) << 32 | static_cast<EntryPosition>(row);
  }
  void add_at(EntryPosition position, double value) {
    if (cursor_ < sequence_.size() && sequence_[cursor_] == position) {
      pattern_.value(slots_[cursor_++]) += value;
    } else {
      add_unexpected(position, value);
    }
  }
  /// Always inlined, so that blocks of a size known at compile time have loops of constant length.
  __attribute__((always_inline)) void add_core_block(const std::int32_t* rows, std::size_t size, const double* lower) {
    if (expects_block(rows, size)) {
      const std::size_t count = entries_of(size);
      const std::uint32_t* slots = slots_.data() + cursor_;
      double* values = pattern_.values();
      for (std::size_t i = 0; i < count; ++i) values[slots[i]] += lower[i];
      cursor_ += count;
      ++next_block_;
      return;
    }
    if (is_at_recorded_block()) {
      replace_block(rows, size, lower);
      return;
    }
    record_block(rows, size);
    for (std::size_t k = 0; k < size; ++k)
      for (std::size_t l = 0; l <= k; ++l)
        add_at(position_of(std::min(rows[k], rows[l]), std::max(rows[k], rows[l])), *lower++);
  }
  void add_unexpected(EntryPosition position, double value);
  bool expects_block(const std::int32_t* rows, std::size_t size) const {
    if (next_block_ >= blocks_.size()) return false;
    const Block& block = blocks_[next_block_];
    return block.cursor == cursor_ && block.size == size && cursor_ + entries_of(size) <= sequence_.size() &&
           std::equal(rows, rows + size, block_rows_.data() + block.first);
  }
  bool is_at_recorded_block() const {
    return unexpected_.empty() && next_block_ < blocks_.size() && blocks_[next_block_].cursor == cursor_ &&
           cursor_ + entries_of(blocks_[next_block_].size) <= sequence_.size();
  }
  void replace_block(const std::int32_t* rows, std::size_t size, const double* lower);
  void record_block(const std::int32_t* rows, std::size_t size);
  void drop_blocks();
  void require_border(Eigen::Index high) {
    if (high >= border_columns_.rows() || high - border_ >= border_columns_.cols()) grow_border(high);
  }
  void grow_border(Eigen::Index high);
  Eigen::Index core_size() const;
  void update_pattern();
  void insert_replaced_blocks();
  std::vector<EntryPosition> new_positions() const;
  CancellationToken cancellation() const { return cancellation_ ? *cancellation_ : CancellationToken(); }
  void check_for_stop() const {
    if (cancellation_) cancellation_->throw_if_requested();
  }

  Numbering numbering_;  ///< empty if no degree of freedom is fixed
  Eigen::Index border_;
  Eigen::Index unknowns_ = 0;            ///< number of unknowns in `numbering_`
  std::vector<EntryPosition> sequence_;  ///< positions in the order in which they were added last
  std::vector<std::uint32_t> slots_;     ///< slot in pattern_ of each entry of sequence_
  std::size_t cursor_ = 0;
  EntryPattern pattern_;
  const CancellationToken* cancellation_ = nullptr;
  /// Values of the last entries of sequence_, which differ from the previous sequence.
  std::vector<double> unexpected_;
  std::vector<ReplacedBlock> replaced_;  ///< in ascending order of blocks, all before the unexpected entries
  std::vector<std::int32_t> replaced_rows_;
  std::vector<Entry> replaced_entries_;
  std::vector<Block> blocks_;  ///< blocks of the sequence
  std::vector<std::int32_t> block_rows_;
  std::size_t next_block_ = 0;
  /// A row for each degree of freedom, a column for each of the border's.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> border_columns_;
};

}  // namespace supple::numerics
