#include "supple/numerics/hessian_entries.h"

#include <numeric>

#include "supple/base/stop_pace.h"

namespace supple::numerics {
namespace {

/// A pattern that grows loses the places that nothing fills any more, once it has so many times those that are filled.
constexpr double worth_forgetting = 1.25;
/// Places that are sorted or looked up between two looks for a stop request: some milliseconds.
constexpr std::size_t places_between_looks = 1 << 16;

/// Sorts pairs of column << 32 | row and leaves each of them once.
///
/// They are put into columns by counting, and of each column the rows are told apart by marks before they are sorted:
/// the places of elements come many times, a column has some dozen rows. O(pairs + columns + rows).
void sort_without_repetition(std::vector<std::uint64_t>& pairs, const CancellationToken& cancellation) {
  const auto column_of = [](std::uint64_t pair) { return static_cast<std::size_t>(pair >> 32); };
  const auto row_of = [](std::uint64_t pair) { return static_cast<std::uint32_t>(pair); };
  StopPace pace(cancellation);
  std::vector<std::size_t> end;  // of each column
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
  std::vector<std::size_t> seen_in(std::size_t{last_row} + 1);  // for each row, one more than the last column
  pairs.clear();
  std::size_t next = 0;
  for (std::size_t column = 0; column < end.size(); ++column) {
    const auto first = static_cast<std::ptrdiff_t>(pairs.size());
    for (; next < end[column]; ++next) {
      pace.look();
      if (std::exchange(seen_in[rows[next]], column + 1) != column + 1) pairs.push_back(column << 32 | rows[next]);
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

std::size_t HessianEntries::find(Place place) const {
  const std::size_t column = place >> 32;
  if (column + 1 >= column_begin_.size()) return pattern_.size();
  const auto begin = pattern_.begin();
  return index(std::lower_bound(begin + static_cast<std::ptrdiff_t>(column_begin_[column]),
                                begin + static_cast<std::ptrdiff_t>(column_begin_[column + 1]), place) -
               begin);
}

std::uint32_t HessianEntries::slot_of(Place place) const {
  return place == held ? 0 : static_cast<std::uint32_t>(find(place)) + 1;
}

void HessianEntries::index_columns() {
  column_begin_.clear();
  for (std::size_t i = 0; i < pattern_.size(); ++i)
    while (column_begin_.size() <= pattern_[i] >> 32) column_begin_.push_back(i);
  column_begin_.push_back(pattern_.size());
}

void HessianEntries::clear() {
  if (!unexpected_.empty() || !replaced_.empty() || cursor_ < sequence_.size()) learn();
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
      replaced_entries_.emplace_back(place_of(std::min(rows[k], rows[l]), std::max(rows[k], rows[l])), *lower++);
  cursor_ += entries_of(blocks_[next_block_].size);
  ++next_block_;
}

void HessianEntries::note_block(const std::int32_t* rows, std::size_t size) {
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

void HessianEntries::add_unexpected(Place place, double value) {
  // Nothing that follows is compared with the old sequence: it would match by accident only.
  sequence_.resize(cursor_);
  sequence_.push_back(place);
  unexpected_.push_back(value);
  if (++cursor_ % places_between_looks == 0) look_for_stop();
}

void HessianEntries::grow_border(Eigen::Index high) {
  const Eigen::Index rows = std::max(border_columns_.rows(), high + 1);
  const Eigen::Index columns = std::max(border_columns_.cols(), high - border_ + 1);
  const auto old = border_columns_;
  border_columns_.setZero(rows, columns);
  border_columns_.topLeftCorner(old.rows(), old.cols()) = old;
}

void HessianEntries::learn() {
  // Those that did not come this time stand for places that the sequence no longer has.
  drop_blocks();
  // Where the sequence ended early, what it lost may come back: its places stay.
  sequence_.resize(cursor_);
  slots_.resize(cursor_ - unexpected_.size());
  if (unexpected_.empty() && replaced_.empty()) return;
  const bool grew = add_to_pattern();
  slots_.reserve(sequence_.size());
  for (const double value : unexpected_) {
    if (slots_.size() % places_between_looks == 0) look_for_stop();
    const std::uint32_t slot = slot_of(sequence_[slots_.size()]);
    values_[slot] += value;
    slots_.push_back(slot);
  }
  unexpected_.clear();
  if (!replaced_.empty()) put_in_sequence();
  cursor_ = sequence_.size();
  // Only where the pattern is another one anyway.
  if (grew) forget_unfilled();
}

/// The blocks that came where others were expected take their places, and what follows moves up.
void HessianEntries::put_in_sequence() {
  const std::size_t from = blocks_[replaced_.front().block].cursor;
  const std::size_t from_row = blocks_[replaced_.front().block].first;
  const std::vector<Place> places(sequence_.begin() + static_cast<std::ptrdiff_t>(from), sequence_.end());
  const std::vector<std::uint32_t> slots(slots_.begin() + static_cast<std::ptrdiff_t>(from), slots_.end());
  const std::vector<std::int32_t> rows(block_rows_.begin() + static_cast<std::ptrdiff_t>(from_row), block_rows_.end());
  sequence_.resize(from);
  slots_.resize(from);
  block_rows_.resize(from_row);
  std::size_t taken = 0;  // of the old sequence, from `from` on
  const auto take_up_to = [&](std::size_t end) {
    for (; taken < end; ++taken) {
      sequence_.push_back(places[taken]);
      slots_.push_back(slots[taken]);
    }
  };
  const std::int32_t* row = replaced_rows_.data();
  const Entry* entry = replaced_entries_.data();
  auto next = replaced_.begin();
  for (std::size_t b = next->block; b < blocks_.size(); ++b) {
    Block& block = blocks_[b];
    take_up_to(block.cursor - from);
    block.cursor = sequence_.size();
    const std::size_t old_first = block.first - from_row;
    block.first = block_rows_.size();
    if (next == replaced_.end() || next->block != b) {
      block_rows_.insert(block_rows_.end(), rows.data() + old_first, rows.data() + old_first + block.size);
      continue;
    }
    look_for_stop();
    taken += entries_of(block.size);
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
  take_up_to(places.size());
  replaced_.clear();
  replaced_rows_.clear();
  replaced_entries_.clear();
}

void HessianEntries::forget_unfilled() {
  std::vector<std::uint32_t> moved(values_.size(), 0);
  for (const std::uint32_t slot : slots_) moved[slot] = 1;
  moved[0] = 0;
  const auto filled = std::count(moved.begin(), moved.end(), 1U);
  if (static_cast<double>(pattern_.size()) <= worth_forgetting * static_cast<double>(filled)) return;
  std::uint32_t next = 0;
  for (std::size_t slot = 1; slot < values_.size(); ++slot) {
    if (moved[slot] == 0) continue;
    moved[slot] = ++next;
    pattern_[next - 1] = pattern_[slot - 1];
    values_[next] = values_[slot];
  }
  pattern_.resize(next);
  values_.resize(next + 1);
  for (std::uint32_t& slot : slots_) slot = moved[slot];
  index_columns();
}

/// Those that the pattern lacks; some come several times.
std::vector<HessianEntries::Place> HessianEntries::fresh_places() const {
  std::vector<Place> fresh;
  fresh.reserve(pattern_.empty() ? replaced_entries_.size() + unexpected_.size() : 0);
  const CancellationToken stop = cancellation();
  StopPace pace(stop);
  const auto take = [&](Place place) {
    pace.look();
    if (place == held) return;
    const std::size_t at = find(place);
    if (at == pattern_.size() || pattern_[at] != place) fresh.push_back(place);
  };
  for (const auto& [place, value] : replaced_entries_) take(place);
  std::for_each(sequence_.end() - static_cast<std::ptrdiff_t>(unexpected_.size()), sequence_.end(), take);
  return fresh;
}

bool HessianEntries::add_to_pattern() {
  std::vector<Place> fresh = fresh_places();
  if (fresh.empty()) return false;
  sort_without_repetition(fresh, cancellation());
  std::vector<Place> merged;
  std::vector<double> values{values_.front()};
  std::vector<std::uint32_t> moved(values_.size());
  merged.reserve(pattern_.size() + fresh.size());
  values.reserve(merged.capacity() + 1);
  // What lies between two new places moves as a whole.
  std::size_t taken = 0;
  const auto take_up_to = [&](std::size_t end) {
    const std::size_t shift = merged.size() - taken;
    for (std::size_t i = taken; i < end; ++i) moved[i + 1] = static_cast<std::uint32_t>(i + 1 + shift);
    const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
    merged.insert(merged.end(), pattern_.begin() + at(taken), pattern_.begin() + at(end));
    values.insert(values.end(), values_.begin() + at(taken + 1), values_.begin() + at(end + 1));
    taken = end;
  };
  for (const Place place : fresh) {
    take_up_to(find(place));
    merged.push_back(place);
    values.push_back(0);
  }
  take_up_to(pattern_.size());
  for (std::uint32_t& slot : slots_) slot = moved[slot];
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
  learn();
  return lower(n).selfadjointView<Eigen::Lower>();
}

void HessianEntries::assemble(Eigen::Index n, BorderedMatrix& into) {
  const Eigen::Index core = core_size();
  if (!unexpected_.empty() || !replaced_.empty() || into.core.rows() != core ||
      into.core.nonZeros() != static_cast<Eigen::Index>(pattern_.size())) {
    learn();
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
