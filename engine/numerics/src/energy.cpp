#include "supple/numerics/energy.h"

#include <algorithm>

namespace supple::numerics {

HessianEntries::HessianEntries(Eigen::Index border) : border_(border) {}

void HessianEntries::clear() {
  if (diverged_ || cursor_ < sequence_.size()) learn();
  std::fill(values_.begin(), values_.end(), 0.0);
  border_columns_.setZero();
  cursor_ = 0;
  next_block_ = 0;
}

void HessianEntries::add_block(const Block& rows, const double* lower) {
  if (next_block_ < blocks_.size() && blocks_[next_block_].first == cursor_ && blocks_[next_block_].second == rows &&
      cursor_ + block_entries <= sequence_.size()) {
    const std::uint32_t* slots = slots_.data() + cursor_;
    for (std::size_t i = 0; i < block_entries; ++i) values_[slots[i]] += lower[i];
    cursor_ += block_entries;
    ++next_block_;
    return;
  }
  blocks_.resize(next_block_++);
  blocks_.emplace_back(cursor_ + unexpected_.size(), rows);
  for (std::size_t k = 0; k < block_size; ++k)
    for (std::size_t l = 0; l <= k; ++l) add(rows[k], rows[l], *lower++);
}

void HessianEntries::add_unexpected(Place place, double value) {
  diverged_ = true;
  // Nothing that follows is compared with the old sequence: it would match by accident only.
  sequence_.resize(cursor_);
  unexpected_.emplace_back(place, value);
}

void HessianEntries::grow_border(Eigen::Index high) {
  const Eigen::Index rows = std::max(border_columns_.rows(), high + 1);
  const Eigen::Index columns = std::max(border_columns_.cols(), high - border_ + 1);
  const auto old = border_columns_;
  border_columns_.setZero(rows, columns);
  border_columns_.topLeftCorner(old.rows(), old.cols()) = old;
}

void HessianEntries::learn() {
  if (!diverged_) {
    // The sequence ended early: what it lost may come back, its places stay.
    sequence_.resize(cursor_);
    slots_.resize(cursor_);
    blocks_.resize(next_block_);
    return;
  }
  add_to_pattern();
  for (const auto& [place, value] : unexpected_) {
    const auto slot =
        static_cast<std::uint32_t>(std::lower_bound(pattern_.begin(), pattern_.end(), place) - pattern_.begin());
    values_[slot] += value;
    sequence_.push_back(place);
    slots_.push_back(slot);
  }
  cursor_ = sequence_.size();
  unexpected_.clear();
  diverged_ = false;
}

void HessianEntries::add_to_pattern() {
  slots_.resize(sequence_.size());
  std::vector<Place> fresh;
  for (const auto& [place, value] : unexpected_)
    if (!std::binary_search(pattern_.begin(), pattern_.end(), place)) fresh.push_back(place);
  if (fresh.empty()) return;
  std::sort(fresh.begin(), fresh.end());
  fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
  std::vector<Place> merged;
  std::vector<double> values;
  std::vector<std::uint32_t> moved(pattern_.size());
  merged.reserve(pattern_.size() + fresh.size());
  values.reserve(merged.capacity());
  auto next = fresh.begin();
  for (std::size_t i = 0; i < pattern_.size(); ++i) {
    for (; next != fresh.end() && *next < pattern_[i]; ++next) {
      merged.push_back(*next);
      values.push_back(0);
    }
    moved[i] = static_cast<std::uint32_t>(merged.size());
    merged.push_back(pattern_[i]);
    values.push_back(values_[i]);
  }
  merged.insert(merged.end(), next, fresh.end());
  values.resize(merged.size(), 0.0);
  for (std::uint32_t& slot : slots_) slot = moved[slot];
  pattern_ = std::move(merged);
  values_ = std::move(values);
}

SparseMatrix HessianEntries::lower(Eigen::Index n) const {
  SparseMatrix matrix(n, n);
  matrix.resizeNonZeros(static_cast<Eigen::Index>(pattern_.size()));
  int* outer = matrix.outerIndexPtr();
  std::fill(outer, outer + n + 1, 0);
  for (std::size_t i = 0; i < pattern_.size(); ++i) {
    ++outer[(pattern_[i] >> 32) + 1];
    matrix.innerIndexPtr()[i] = static_cast<int>(pattern_[i] & 0xffffffffU);
    matrix.valuePtr()[i] = values_[i];
  }
  for (Eigen::Index column = 0; column < n; ++column) outer[column + 1] += outer[column];
  return matrix;
}

SparseMatrix HessianEntries::matrix(Eigen::Index n) {
  learn();
  return lower(n).selfadjointView<Eigen::Lower>();
}

void HessianEntries::assemble(Eigen::Index n, BorderedMatrix& into) {
  if (diverged_ || into.core.rows() != border_ || into.core.nonZeros() != static_cast<Eigen::Index>(pattern_.size())) {
    learn();
    into.core = lower(border_);
  } else {
    std::copy(values_.begin(), values_.end(), into.core.valuePtr());
  }
  const Eigen::Index border = n - border_;
  if (border_columns_.rows() != n || border_columns_.cols() != border) {
    const auto old = border_columns_;
    border_columns_.setZero(n, border);
    border_columns_.topLeftCorner(old.rows(), old.cols()) = old;
  }
  into.border = border_columns_.topRows(border_);
  into.corner = Eigen::MatrixXd(border_columns_.bottomRows(border)).selfadjointView<Eigen::Upper>();
}

}  // namespace supple::numerics
