#include "supple/numerics/entry_pattern.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "supple/base/stop_pace.h"

namespace supple::numerics {
namespace {

/// A pattern that grows loses its unfilled positions, once it has this many times as many positions as are filled.
constexpr double max_unfilled_ratio = 1.25;

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
    pace.check();
    if (column_of(pair) >= end.size()) end.resize(column_of(pair) + 1);
    ++end[column_of(pair)];
    last_row = std::max(last_row, row_of(pair));
  }
  std::exclusive_scan(end.begin(), end.end(), end.begin(), std::size_t{0});
  std::vector<std::uint32_t> rows(pairs.size());
  for (const std::uint64_t pair : pairs) {
    pace.check();
    rows[end[column_of(pair)]++] = row_of(pair);
  }
  std::vector<std::size_t> last_column(std::size_t{last_row} + 1);  // for each row, 1 + the last column that had it
  pairs.clear();
  std::size_t next = 0;
  for (std::size_t column = 0; column < end.size(); ++column) {
    const auto first = static_cast<std::ptrdiff_t>(pairs.size());
    for (; next < end[column]; ++next) {
      pace.check();
      if (std::exchange(last_column[rows[next]], column + 1) != column + 1) pairs.push_back(column << 32 | rows[next]);
    }
    std::sort(pairs.begin() + first, pairs.end());
  }
}

}  // namespace

std::size_t EntryPattern::find(EntryPosition position) const {
  const std::size_t column = position >> 32;
  if (column + 1 >= column_begin_.size()) return positions_.size();
  const auto begin = positions_.begin();
  return static_cast<std::size_t>(std::lower_bound(begin + static_cast<std::ptrdiff_t>(column_begin_[column]),
                                                   begin + static_cast<std::ptrdiff_t>(column_begin_[column + 1]),
                                                   position) -
                                  begin);
}

void EntryPattern::index_columns() {
  column_begin_.clear();
  for (std::size_t i = 0; i < positions_.size(); ++i)
    while (column_begin_.size() <= positions_[i] >> 32) column_begin_.push_back(i);
  column_begin_.push_back(positions_.size());
}

void EntryPattern::set_zero() { std::ranges::fill(values_, 0.0); }

void EntryPattern::insert(std::vector<EntryPosition> added, std::vector<std::uint32_t>& slots,
                          const CancellationToken& cancellation) {
  sort_without_repetition(added, cancellation);
  std::vector<EntryPosition> merged;
  std::vector<double> values{values_.front()};
  std::vector<std::uint32_t> new_slot(values_.size());
  merged.reserve(positions_.size() + added.size());
  values.reserve(merged.capacity() + 1);
  // All entries between two new positions move by the same amount.
  std::size_t copied = 0;
  const auto copy_up_to = [&](std::size_t end) {
    const std::size_t shift = merged.size() - copied;
    for (std::size_t i = copied; i < end; ++i) new_slot[i + 1] = static_cast<std::uint32_t>(i + 1 + shift);
    const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
    merged.insert(merged.end(), positions_.begin() + at(copied), positions_.begin() + at(end));
    values.insert(values.end(), values_.begin() + at(copied + 1), values_.begin() + at(end + 1));
    copied = end;
  };
  for (const EntryPosition position : added) {
    copy_up_to(find(position));
    merged.push_back(position);
    values.push_back(0);
  }
  copy_up_to(positions_.size());
  for (std::uint32_t& slot : slots) slot = new_slot[slot];
  positions_ = std::move(merged);
  values_ = std::move(values);
  index_columns();
}

void EntryPattern::remove_unfilled(std::vector<std::uint32_t>& slots) {
  std::vector<std::uint32_t> new_slot(values_.size(), 0);
  for (const std::uint32_t slot : slots) new_slot[slot] = 1;
  new_slot[0] = 0;
  const auto filled = std::count(new_slot.begin(), new_slot.end(), 1U);
  if (static_cast<double>(positions_.size()) <= max_unfilled_ratio * static_cast<double>(filled)) return;
  std::uint32_t next = 0;
  for (std::size_t slot = 1; slot < values_.size(); ++slot) {
    if (new_slot[slot] == 0) continue;
    new_slot[slot] = ++next;
    positions_[next - 1] = positions_[slot - 1];
    values_[next] = values_[slot];
  }
  positions_.resize(next);
  values_.resize(next + 1);
  for (std::uint32_t& slot : slots) slot = new_slot[slot];
  index_columns();
}

SparseMatrix EntryPattern::lower(Eigen::Index n) const {
  SparseMatrix matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(positions_.size()));
  int* outer = matrix.outerIndexPtr();
  std::fill(outer, outer + n + 1, 0);
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    ++outer[(positions_[i] >> 32) + 1];
    matrix.innerIndexPtr()[i] = static_cast<int>(positions_[i] & 0xffffffffU);
    matrix.valuePtr()[i] = values_[i + 1];
  }
  for (Eigen::Index column = 0; column < n; ++column) outer[column + 1] += outer[column];
  return matrix;
}

}  // namespace supple::numerics
