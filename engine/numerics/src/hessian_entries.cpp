#include "supple/numerics/hessian_entries.h"

#include <numeric>

#include "supple/base/stop_pace.h"

namespace supple::numerics {
namespace {

/// A pattern that grows loses its unfilled positions, once it has this many times as many positions as are filled.
constexpr double max_unfilled_ratio = 1.25;
/// Positions that are sorted or looked up between two checks for a stop request, which takes some milliseconds.
constexpr std::size_t positions_between_checks = 1 << 16;

/// Sorts pairs of column << 32 | row and removes repetitions. O(pairs + columns + rows).
///
/// A counting sort distributes them to columns. In each column, marks remove repeated rows before the rows are sorted:
/// elements repeat most positions, so only some dozen different rows remain.
void sort_without_repetition(std::vector<std::uint64_t>& pairs, const CancellationToken& cancellation) {
  const auto column_of = [](std::uint64_t pair) { return static_cast<std::size_t>(pair >> 32); };
  const auto row_of = [](std::uint64_t pair) { return static_cast<std::uint32_t>(pair); };
  StopPace pace(cancellation);
  std::vector<std::size_t> end;  // end of each column
  std::uint32_t last_row = 0;
  for (const std::uint64_t pair : pairs) {
    pace.look();
    if (column_of(pair) >= end.size()) end.resize(column_of(pair) + 1);
    ++end[column_of(pair)];
    last_row = std::max(last_row, row_of(pair));
  }
  std::exclusive_scan(end.begin(), end.end(), end.begin(), std::size_t{0});
  std::vector<std::uint32_t> rows(pairs.size());
  for (const std::uint64_t pair : pairs) {
    pace.look();
    rows[end[column_of(pair)]++] = row_of(pair);
  }
  std::vector<std::size_t> last_column(std::size_t{last_row} + 1);  // for each row, 1 + the last column that had it
  pairs.clear();
  std::size_t next = 0;
  for (std::size_t column = 0; column < end.size(); ++column) {
    const auto first = static_cast<std::ptrdiff_t>(pairs.size());
    for (; next < end[column]; ++next) {
      pace.look();
      if (std::exchange(last_column[rows[next]], column + 1) != column + 1) pairs.push_back(column << 32 | rows[next]);
    }
    std::sort(pairs.begin() + first, pairs.end());
  }
}

}  // namespace

HessianEntries::HessianEntries(Eigen::Index border) : border_(border) {}

HessianEntries::HessianEntries(Numbering numbering)
    : numbering_(std::move(numbering)), border_(static_cast<Eigen::Index>(numbering_.size())) {
  unknowns_ = std::ranges::count_if(numbering_, [](std::int32_t number) { return number >= 0; });
  if (unknowns_ == border_) numbering_.clear();
}

Eigen::Index HessianEntries::core_size() const { return numbering_.empty() ? border_ : unknowns_; }

std::size_t HessianEntries::find(Position position) const {
  const std::size_t column = position >> 32;
  if (column + 1 >= column_begin_.size()) return pattern_.size();
  const auto begin = pattern_.begin();
  return index(std::lower_bound(begin + static_cast<std::ptrdiff_t>(column_begin_[column]),
                                begin + static_cast<std::ptrdiff_t>(column_begin_[column + 1]), position) -
               begin);
}

std::uint32_t HessianEntries::slot_of(Position position) const {
  return position == no_position ? 0 : static_cast<std::uint32_t>(find(position)) + 1;
}

void HessianEntries::index_columns() {
  column_begin_.clear();
  for (std::size_t i = 0; i < pattern_.size(); ++i)
    while (column_begin_.size() <= pattern_[i] >> 32) column_begin_.push_back(i);
  column_begin_.push_back(pattern_.size());
}

void HessianEntries::clear() {
  if (!unexpected_.empty() || !replaced_.empty() || cursor_ < sequence_.size()) update_pattern();
  std::ranges::fill(values_, 0.0);
  border_columns_.setZero();
  cursor_ = 0;
  next_block_ = 0;
}

void HessianEntries::add_block(std::span<const std::int32_t> rows, const double* lower) {
  const auto in_core = static_cast<std::size_t>(
      std::find_if(rows.begin(), rows.end(), [this](std::int32_t row) { return row >= border_; }) - rows.begin());
  if (in_core > 0) add_core_block(rows.data(), in_core, lower);
  lower += entries_of(in_core);
  for (std::size_t k = in_core; k < rows.size(); ++k)
    for (std::size_t l = 0; l <= k; ++l) add(rows[k], rows[l], *lower++);
}

void HessianEntries::replace_block(const std::int32_t* rows, std::size_t size, const double* lower) {
  replaced_.push_back({next_block_, size});
  replaced_rows_.insert(replaced_rows_.end(), rows, rows + size);
  for (std::size_t k = 0; k < size; ++k)
    for (std::size_t l = 0; l <= k; ++l)
      replaced_entries_.emplace_back(position_of(std::min(rows[k], rows[l]), std::max(rows[k], rows[l])), *lower++);
  cursor_ += entries_of(blocks_[next_block_].size);
  ++next_block_;
}

void HessianEntries::record_block(const std::int32_t* rows, std::size_t size) {
  drop_blocks();
  blocks_.push_back({cursor_, block_rows_.size(), size});
  block_rows_.insert(block_rows_.end(), rows, rows + size);
  ++next_block_;
}

void HessianEntries::drop_blocks() {
  if (next_block_ >= blocks_.size()) return;
  block_rows_.resize(blocks_[next_block_].first);
  blocks_.resize(next_block_);
}

void HessianEntries::add_unexpected(Position position, double value) {
  // The rest is not compared with the old sequence, because it would match by accident only.
  sequence_.resize(cursor_);
  sequence_.push_back(position);
  unexpected_.push_back(value);
  if (++cursor_ % positions_between_checks == 0) check_for_stop();
}

void HessianEntries::grow_border(Eigen::Index high) {
  const Eigen::Index rows = std::max(border_columns_.rows(), high + 1);
  const Eigen::Index columns = std::max(border_columns_.cols(), high - border_ + 1);
  const auto old = border_columns_;
  border_columns_.setZero(rows, columns);
  border_columns_.topLeftCorner(old.rows(), old.cols()) = old;
}

void HessianEntries::update_pattern() {
  // Blocks that were not added this time refer to entries that the sequence no longer has.
  drop_blocks();
  // If the sequence ended early, the missing entries may return later, so their positions stay in the pattern.
  sequence_.resize(cursor_);
  slots_.resize(cursor_ - unexpected_.size());
  if (unexpected_.empty() && replaced_.empty()) return;
  const bool grew = add_to_pattern();
  slots_.reserve(sequence_.size());
  for (const double value : unexpected_) {
    if (slots_.size() % positions_between_checks == 0) check_for_stop();
    const std::uint32_t slot = slot_of(sequence_[slots_.size()]);
    values_[slot] += value;
    slots_.push_back(slot);
  }
  unexpected_.clear();
  if (!replaced_.empty()) insert_replaced_blocks();
  cursor_ = sequence_.size();
  // Factorizations repeat their symbolic analysis only if the pattern changes, which it does here anyway.
  if (grew) remove_unfilled();
}

/// Inserts the replaced blocks into the sequence, and moves the entries that follow them.
void HessianEntries::insert_replaced_blocks() {
  const std::size_t from = blocks_[replaced_.front().block].cursor;
  const std::size_t from_row = blocks_[replaced_.front().block].first;
  const std::vector<Position> positions(sequence_.begin() + static_cast<std::ptrdiff_t>(from), sequence_.end());
  const std::vector<std::uint32_t> slots(slots_.begin() + static_cast<std::ptrdiff_t>(from), slots_.end());
  const std::vector<std::int32_t> rows(block_rows_.begin() + static_cast<std::ptrdiff_t>(from_row), block_rows_.end());
  sequence_.resize(from);
  slots_.resize(from);
  block_rows_.resize(from_row);
  std::size_t copied = 0;  // number of old entries, from `from` on, that were copied or replaced
  const auto copy_up_to = [&](std::size_t end) {
    for (; copied < end; ++copied) {
      sequence_.push_back(positions[copied]);
      slots_.push_back(slots[copied]);
    }
  };
  const std::int32_t* row = replaced_rows_.data();
  const Entry* entry = replaced_entries_.data();
  auto next = replaced_.begin();
  for (std::size_t b = next->block; b < blocks_.size(); ++b) {
    Block& block = blocks_[b];
    copy_up_to(block.cursor - from);
    block.cursor = sequence_.size();
    const std::size_t old_first = block.first - from_row;
    block.first = block_rows_.size();
    if (next == replaced_.end() || next->block != b) {
      block_rows_.insert(block_rows_.end(), rows.data() + old_first, rows.data() + old_first + block.size);
      continue;
    }
    check_for_stop();
    copied += entries_of(block.size);
    block.size = next->size;
    block_rows_.insert(block_rows_.end(), row, row + block.size);
    row += block.size;
    for (std::size_t i = 0; i < entries_of(block.size); ++i, ++entry) {
      const std::uint32_t slot = slot_of(entry->first);
      values_[slot] += entry->second;
      sequence_.push_back(entry->first);
      slots_.push_back(slot);
    }
    ++next;
  }
  copy_up_to(positions.size());
  replaced_.clear();
  replaced_rows_.clear();
  replaced_entries_.clear();
}

void HessianEntries::remove_unfilled() {
  std::vector<std::uint32_t> new_slot(values_.size(), 0);
  for (const std::uint32_t slot : slots_) new_slot[slot] = 1;
  new_slot[0] = 0;
  const auto filled = std::count(new_slot.begin(), new_slot.end(), 1U);
  if (static_cast<double>(pattern_.size()) <= max_unfilled_ratio * static_cast<double>(filled)) return;
  std::uint32_t next = 0;
  for (std::size_t slot = 1; slot < values_.size(); ++slot) {
    if (new_slot[slot] == 0) continue;
    new_slot[slot] = ++next;
    pattern_[next - 1] = pattern_[slot - 1];
    values_[next] = values_[slot];
  }
  pattern_.resize(next);
  values_.resize(next + 1);
  for (std::uint32_t& slot : slots_) slot = new_slot[slot];
  index_columns();
}

/// The added positions that the pattern lacks; some of them repeat.
std::vector<HessianEntries::Position> HessianEntries::new_positions() const {
  std::vector<Position> added;
  added.reserve(pattern_.empty() ? replaced_entries_.size() + unexpected_.size() : 0);
  const CancellationToken token = cancellation();
  StopPace pace(token);
  const auto collect = [&](Position position) {
    pace.look();
    if (position == no_position) return;
    const std::size_t at = find(position);
    if (at == pattern_.size() || pattern_[at] != position) added.push_back(position);
  };
  for (const auto& [position, value] : replaced_entries_) collect(position);
  std::for_each(sequence_.end() - static_cast<std::ptrdiff_t>(unexpected_.size()), sequence_.end(), collect);
  return added;
}

bool HessianEntries::add_to_pattern() {
  std::vector<Position> added = new_positions();
  if (added.empty()) return false;
  sort_without_repetition(added, cancellation());
  std::vector<Position> merged;
  std::vector<double> values{values_.front()};
  std::vector<std::uint32_t> new_slot(values_.size());
  merged.reserve(pattern_.size() + added.size());
  values.reserve(merged.capacity() + 1);
  // All entries between two new positions move by the same amount.
  std::size_t copied = 0;
  const auto copy_up_to = [&](std::size_t end) {
    const std::size_t shift = merged.size() - copied;
    for (std::size_t i = copied; i < end; ++i) new_slot[i + 1] = static_cast<std::uint32_t>(i + 1 + shift);
    const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
    merged.insert(merged.end(), pattern_.begin() + at(copied), pattern_.begin() + at(end));
    values.insert(values.end(), values_.begin() + at(copied + 1), values_.begin() + at(end + 1));
    copied = end;
  };
  for (const Position position : added) {
    copy_up_to(find(position));
    merged.push_back(position);
    values.push_back(0);
  }
  copy_up_to(pattern_.size());
  for (std::uint32_t& slot : slots_) slot = new_slot[slot];
  pattern_ = std::move(merged);
  values_ = std::move(values);
  index_columns();
  return true;
}

SparseMatrix HessianEntries::lower(Eigen::Index n) const {
  SparseMatrix matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(pattern_.size()));
  int* outer = matrix.outerIndexPtr();
  std::fill(outer, outer + n + 1, 0);
  for (std::size_t i = 0; i < pattern_.size(); ++i) {
    ++outer[(pattern_[i] >> 32) + 1];
    matrix.innerIndexPtr()[i] = static_cast<int>(pattern_[i] & 0xffffffffU);
    matrix.valuePtr()[i] = values_[i + 1];
  }
  for (Eigen::Index column = 0; column < n; ++column) outer[column + 1] += outer[column];
  return matrix;
}

SparseMatrix HessianEntries::matrix(Eigen::Index n) {
  update_pattern();
  return lower(n).selfadjointView<Eigen::Lower>();
}

void HessianEntries::assemble(Eigen::Index n, BorderedMatrix& into) {
  const Eigen::Index core = core_size();
  if (!unexpected_.empty() || !replaced_.empty() || into.core.rows() != core ||
      into.core.nonZeros() != static_cast<Eigen::Index>(pattern_.size())) {
    update_pattern();
    into.core = lower(core);
  } else {
    std::copy(values_.begin() + 1, values_.end(), into.core.valuePtr());
  }
  const Eigen::Index border = n - border_;
  if (border_columns_.rows() != n || border_columns_.cols() != border) {
    const auto old = border_columns_;
    border_columns_.setZero(n, border);
    border_columns_.topLeftCorner(old.rows(), old.cols()) = old;
  }
  if (numbering_.empty()) {
    into.border = border_columns_.topRows(border_);
  } else {
    into.border.resize(core, border);
    for (Eigen::Index i = 0; i < border_ && border > 0; ++i)
      if (const std::int32_t row = numbering_[static_cast<std::size_t>(i)]; row >= 0)
        into.border.row(row) = border_columns_.row(i);
  }
  into.corner = Eigen::MatrixXd(border_columns_.bottomRows(border)).selfadjointView<Eigen::Upper>();
}

}  // namespace supple::numerics
