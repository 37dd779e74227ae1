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
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// Which unknown each degree of freedom is, in ascending order; -1 where it is held.
using Numbering = std::vector<std::int32_t>;

/// Second derivatives as they are added. The matrix is symmetric: an unordered pair of degrees of freedom is one place,
/// each entry is given once, and entries of the same place add up.
///
/// Terms add the same places in the same order at every state, or nearly so. The first assembly sorts them; later ones
/// recognize the sequence and add each value straight to its place. A block that comes in the place of another, as
/// where a path leads over other faces, costs its own entries alone; where single entries or the number of blocks
/// change, all that follows is looked up: what changes so is best added last. Places once seen stay in the pattern, so
/// that factorizations keep their symbolic analysis while contacts come and go, until many of them are empty and the
/// pattern has to change anyway.
class HessianEntries {
 public:
  /// Degrees of freedom from `border` on are few and couple with all others: they are kept as dense columns. All are
  /// unknowns.
  explicit HessianEntries(Eigen::Index border = std::numeric_limits<std::int32_t>::max());
  /// Degrees of freedom beyond the numbering are the border's. Entries of held ones are dropped: rows and columns of
  /// the core are numbered by unknowns.
  explicit HessianEntries(Numbering numbering);

  void add(Eigen::Index i, Eigen::Index j, double value) {
    const auto [low, high] = i < j ? std::pair(i, j) : std::pair(j, i);
    if (high >= border_) {
      require_border(high);
      border_columns_(low, high - border_) += value;
      return;
    }
    const Place place = place_of(low, high);
    if (place != held) add_at(place, value);
  }

  /// Whether what is added for a degree of freedom is dropped.
  bool drops(Eigen::Index i) const { return i < border_ && !numbering_.empty() && numbering_[index(i)] < 0; }

  /// How many entries the lower triangle of an element's matrix has.
  static constexpr std::size_t entries_of(std::size_t rows) { return rows * (rows + 1) / 2; }

  /// An element's matrix at once: `rows` are its degrees of freedom, all below the border, and lower[k (k + 1) / 2 + l]
  /// is the entry of rows[k] and rows[l], l <= k; of two equal rows both orders. The same as adding these one by one,
  /// several times as fast.
  template <std::size_t size>
  void add_block(const std::array<std::int32_t, size>& rows, const double* lower) {
    add_core_block(rows.data(), size, lower);
  }

  /// The same for any number of rows, each another one, of which those of the border are the last.
  void add_block(std::span<const std::int32_t> rows, const double* lower);

  /// The entries of `row` and first, first + 1, ..., all greater than `row`; fast where `first` is the border's first.
  template <int count>
  void add_row(Eigen::Index row, Eigen::Index first, const double* values) {
    if (first == border_) {
      require_border(border_ + count - 1);
      for (int k = 0; k < count; ++k) border_columns_(row, k) += values[k];
    } else {
      for (int k = 0; k < count; ++k) add(row, first + k, values[k]);
    }
  }

  /// Looks for a stop request while places are sorted; null for none. Outlives this or the next call.
  void stop_with(const CancellationToken* cancellation) { cancellation_ = cancellation; }

  /// Zeroes the values and begins again at the start of the sequence.
  void clear();

  /// The n x n matrix of all unknowns, both triangles filled; without a border.
  SparseMatrix matrix(Eigen::Index n);

  /// The same matrix in parts, for n degrees of freedom. The core and the border's rows are of the unknowns only.
  void assemble(Eigen::Index n, BorderedMatrix& into);

 private:
  using Place = std::uint64_t;  ///< column << 32 | row of the lower triangle: sorting gives compressed columns
  static constexpr Place held = std::numeric_limits<Place>::max();  ///< no place: an entry of a block that is dropped
  struct Block {
    std::size_t cursor;  ///< where in the sequence it begins
    std::size_t first;   ///< of its rows, in block_rows_
    std::size_t size;
  };
  /// A block that came where another one was expected. Its rows and entries are the next in replaced_rows_ and
  /// replaced_entries_.
  struct Replaced {
    std::size_t block;  ///< index into blocks_
    std::size_t size;
  };
  using Entry = std::pair<Place, double>;

  static std::size_t index(Eigen::Index i) { return static_cast<std::size_t>(i); }
  /// Of unknowns, for low <= high below the border; `held` where one of the two is.
  Place place_of(Eigen::Index low, Eigen::Index high) const {
    if (numbering_.empty()) return static_cast<Place>(low) << 32 | static_cast<Place>(high);
    const std::int32_t column = numbering_[index(low)];
    const std::int32_t row = numbering_[index(high)];
    if (column < 0 || row < 0) return held;
    return static_cast<Place>(column) << 32 | static_cast<Place>(row);
  }
  void add_at(Place place, double value) {
    if (cursor_ < sequence_.size() && sequence_[cursor_] == place) {
      values_[slots_[cursor_++]] += value;
    } else {
      add_unexpected(place, value);
    }
  }
  /// Inlined, so that blocks of a known size have loops of known lengths.
  __attribute__((always_inline)) void add_core_block(const std::int32_t* rows, std::size_t size, const double* lower) {
    if (expects_block(rows, size)) {
      const std::size_t count = entries_of(size);
      const std::uint32_t* slots = slots_.data() + cursor_;
      for (std::size_t i = 0; i < count; ++i) values_[slots[i]] += lower[i];
      cursor_ += count;
      ++next_block_;
      return;
    }
    if (stands_where_block_was()) {
      replace_block(rows, size, lower);
      return;
    }
    note_block(rows, size);
    for (std::size_t k = 0; k < size; ++k)
      for (std::size_t l = 0; l <= k; ++l)
        add_at(place_of(std::min(rows[k], rows[l]), std::max(rows[k], rows[l])), *lower++);
  }
  void add_unexpected(Place place, double value);
  bool expects_block(const std::int32_t* rows, std::size_t size) const {
    if (next_block_ >= blocks_.size()) return false;
    const Block& block = blocks_[next_block_];
    return block.cursor == cursor_ && block.size == size && cursor_ + entries_of(size) <= sequence_.size() &&
           std::equal(rows, rows + size, block_rows_.data() + block.first);
  }
  bool stands_where_block_was() const {
    return unexpected_.empty() && next_block_ < blocks_.size() && blocks_[next_block_].cursor == cursor_ &&
           cursor_ + entries_of(blocks_[next_block_].size) <= sequence_.size();
  }
  void replace_block(const std::int32_t* rows, std::size_t size, const double* lower);
  void note_block(const std::int32_t* rows, std::size_t size);
  void drop_blocks();
  void require_border(Eigen::Index high) {
    if (high >= border_columns_.rows() || high - border_ >= border_columns_.cols()) grow_border(high);
  }
  void grow_border(Eigen::Index high);
  Eigen::Index core_size() const;
  /// The index into pattern_ of a place, or of the one before which it would stand.
  std::size_t find(Place place) const;
  std::uint32_t slot_of(Place place) const;
  void index_columns();
  void learn();
  void put_in_sequence();
  std::vector<Place> fresh_places() const;
  bool add_to_pattern();
  void forget_unfilled();
  CancellationToken cancellation() const { return cancellation_ ? *cancellation_ : CancellationToken(); }
  void look_for_stop() const {
    if (cancellation_) cancellation_->throw_if_requested();
  }
  SparseMatrix lower(Eigen::Index n) const;

  Numbering numbering_;  ///< empty: none is held
  Eigen::Index border_;
  Eigen::Index unknowns_ = 0;         ///< that `numbering_` counts
  std::vector<Place> sequence_;       ///< places in the order in which they were added last
  std::vector<std::uint32_t> slots_;  ///< for each of them the index into values_
  std::size_t cursor_ = 0;
  std::vector<Place> pattern_;                ///< places, sorted, without repetition
  std::vector<std::size_t> column_begin_{0};  ///< of each column in pattern_, and its end
  /// One for each place of the pattern, after the first, which receives what is dropped.
  std::vector<double> values_{0};
  const CancellationToken* cancellation_ = nullptr;
  std::vector<double> unexpected_;  ///< values for the end of sequence_, from where it became another one this time
  std::vector<Replaced> replaced_;  ///< by ascending blocks, all before the end that is unexpected
  std::vector<std::int32_t> replaced_rows_;
  std::vector<Entry> replaced_entries_;
  std::vector<Block> blocks_;  ///< those of the sequence
  std::vector<std::int32_t> block_rows_;
  std::size_t next_block_ = 0;
  /// Row: any degree of freedom; column: one of the border's.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> border_columns_;
};

}  // namespace supple::numerics
