#include "supple/numerics/hessian_entries.h"

#include <algorithm>
#include <utility>

#include "supple/base/stop_pace.h"

namespace supple::numerics {
namespace {

/// Positions that are sorted or looked up between two checks for a stop request, which takes some milliseconds.
constexpr std::size_t positions_between_checks = 1 << 16;

}  // namespace

HessianEntries::HessianEntries(Eigen::Index border) : border_(border) {}

HessianEntries::HessianEntries(Numbering numbering)
    : numbering_(std::move(numbering)), border_(static_cast<Eigen::Index>(numbering_.size())) {
  unknowns_ = std::ranges::count_if(numbering_, [](std::int32_t number) { return number >= 0; });
  if (unknowns_ == border_) numbering_.clear();
}

Eigen::Index HessianEntries::core_size() const { return numbering_.empty() ? border_ : unknowns_; }

void HessianEntries::clear() {
  if (!unexpected_.empty() || !replaced_.empty() || cursor_ < sequence_.size()) update_pattern();
  pattern_.set_zero();
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

void HessianEntries::add_unexpected(EntryPosition position, double value) {
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
  std::vector<EntryPosition> added = new_positions();
  const bool grew = !added.empty();
  if (grew) pattern_.insert(std::move(added), slots_, cancellation());
  slots_.reserve(sequence_.size());
  for (const double value : unexpected_) {
    if (slots_.size() % positions_between_checks == 0) check_for_stop();
    const std::uint32_t slot = pattern_.slot_of(sequence_[slots_.size()]);
    pattern_.value(slot) += value;
    slots_.push_back(slot);
  }
  unexpected_.clear();
  if (!replaced_.empty()) insert_replaced_blocks();
  cursor_ = sequence_.size();
  // Factorizations repeat their symbolic analysis only if the pattern changes, which it does here anyway.
  if (grew) pattern_.remove_unfilled(slots_);
}

/// The added positions that the pattern lacks; some of them repeat.
std::vector<EntryPosition> HessianEntries::new_positions() const {
  std::vector<EntryPosition> added;
  added.reserve(pattern_.size() == 0 ? replaced_entries_.size() + unexpected_.size() : 0);
  const CancellationToken token = cancellation();
  StopPace pace(token);
  const auto collect = [&](EntryPosition position) {
    pace.check();
    if (position == no_position) return;
    if (!pattern_.has(position)) added.push_back(position);
  };
  for (const auto& [position, value] : replaced_entries_) collect(position);
  std::for_each(sequence_.end() - static_cast<std::ptrdiff_t>(unexpected_.size()), sequence_.end(), collect);
  return added;
}

/// Inserts the replaced blocks into the sequence, and moves the entries that follow them.
void HessianEntries::insert_replaced_blocks() {
  const std::size_t from = blocks_[replaced_.front().block].cursor;
  const std::size_t from_row = blocks_[replaced_.front().block].first;
  const std::vector<EntryPosition> positions(sequence_.begin() + static_cast<std::ptrdiff_t>(from), sequence_.end());
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
      const std::uint32_t slot = pattern_.slot_of(entry->first);
      pattern_.value(slot) += entry->second;
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

SparseMatrix HessianEntries::matrix(Eigen::Index n) {
  update_pattern();
  return pattern_.lower(n).selfadjointView<Eigen::Lower>();
}

void HessianEntries::assemble(Eigen::Index n, BorderedMatrix& into) {
  const Eigen::Index core = core_size();
  if (!unexpected_.empty() || !replaced_.empty() || into.core.rows() != core ||
      into.core.nonZeros() != static_cast<Eigen::Index>(pattern_.size())) {
    update_pattern();
    into.core = pattern_.lower(core);
  } else {
    std::copy(pattern_.begin(), pattern_.end(), into.core.valuePtr());
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
