#include "multifrontal_cholesky.h"

#include <algorithm>
#include <utility>

#include "partial_cholesky.h"
#include "symbolic_analysis.h"

namespace supple::numerics {
namespace {

/// A known ordering is given up once the factor has this many times the entries it had with its own pattern.
constexpr double worth_reordering = 1.3;

/// A multiple of four rows: every column of a panel then starts at the same alignment.
int padded(int rows) { return (rows + 3) / 4 * 4; }

}  // namespace

void MultifrontalCholesky::analyze(const SparseMatrix& matrix) {
  // A few more places, as contacts bring them, change the best ordering little; finding it anew costs more than some
  // factorizations.
  std::vector<int> known;
  if (n_ == matrix.rows()) known = old_index_;
  SymbolicAnalysis analysis = analyse(matrix, known, cancellation_);
  if (!known.empty() && analysis.entries > worth_reordering * best_entries_)
    analysis = analyse(matrix, {}, cancellation_);
  if (known.empty() || analysis.entries < best_entries_) best_entries_ = analysis.entries;
  n_ = static_cast<int>(matrix.rows());
  const std::vector<int>& first = analysis.first;
  const std::vector<int>& row_begin = analysis.row_begin;
  old_index_ = std::move(analysis.old_index);
  new_index_.resize(static_cast<std::size_t>(n_));
  for (int i = 0; i < n_; ++i) new_index_[static_cast<std::size_t>(old_index_[static_cast<std::size_t>(i)])] = i;

  const std::size_t count = first.size() - 1;
  rows_ = std::move(analysis.rows);
  supernodes_.assign(count + 1, {});
  std::int64_t panel = 0;
  std::int64_t relative = 0;
  for (std::size_t s = 0; s < count; ++s) {
    Supernode& node = supernodes_[s];
    node.first = first[s];
    node.pivots = first[s + 1] - first[s];
    node.rows = row_begin[s + 1] - row_begin[s];
    node.ld = padded(node.rows);
    node.row_list = row_begin[s];
    node.panel = panel;
    node.relative = relative;
    panel += static_cast<std::int64_t>(node.ld) * node.pivots;
    relative += node.rows - node.pivots;
  }
  supernodes_[count].first = n_;
  cancellation_.throw_if_requested();
  factor_.resize(static_cast<std::size_t>(panel));
  find_relative_rows();
  cancellation_.throw_if_requested();
  place_entries(matrix);
}

void MultifrontalCholesky::find_relative_rows() {
  const std::size_t count = supernodes_.size() - 1;
  std::vector<int> supernode_of(static_cast<std::size_t>(n_));
  for (std::size_t s = 0; s < count; ++s)
    std::fill_n(supernode_of.begin() + supernodes_[s].first, supernodes_[s].pivots, static_cast<int>(s));
  relative_.clear();
  std::size_t largest_front = 0;
  std::size_t stacked = 0;
  std::size_t most_stacked = 0;
  std::vector<std::size_t> waiting(count, 0);  // update entries on the stack that belong to the children of each
  for (std::size_t s = 0; s < count; ++s) {
    Supernode& node = supernodes_[s];
    const int below = node.rows - node.pivots;
    largest_front = std::max(largest_front, static_cast<std::size_t>(node.ld) * static_cast<std::size_t>(node.rows));
    stacked -= waiting[s];
    if (below == 0) continue;
    const int* list = rows_.data() + node.row_list + node.pivots;
    node.parent = supernode_of[static_cast<std::size_t>(list[0])];
    const Supernode& parent = supernodes_[static_cast<std::size_t>(node.parent)];
    const int* at = rows_.data() + parent.row_list;
    int place = 0;
    for (int r = 0; r < below; ++r) {
      while (at[place] != list[r]) ++place;
      relative_.push_back(place);
    }
    const std::size_t size = static_cast<std::size_t>(below) * static_cast<std::size_t>(below);
    waiting[static_cast<std::size_t>(node.parent)] += size;
    stacked += size;
    most_stacked = std::max(most_stacked, stacked);
  }
  front_.resize(largest_front);
  updates_.resize(most_stacked);
}

void MultifrontalCholesky::place_entries(const SparseMatrix& matrix) {
  struct Entry {
    int supernode;
    std::int32_t place;
    std::int64_t slot;
  };
  const std::size_t count = supernodes_.size() - 1;
  std::vector<int> supernode_of(static_cast<std::size_t>(n_));
  for (std::size_t s = 0; s < count; ++s)
    std::fill_n(supernode_of.begin() + supernodes_[s].first, supernodes_[s].pivots, static_cast<int>(s));
  std::vector<Entry> entries;
  entries.reserve(static_cast<std::size_t>(matrix.nonZeros()));
  constexpr int columns_between_looks = 1 << 15;
  for (int column = 0; column < n_; ++column) {
    if (column % columns_between_looks == 0) cancellation_.throw_if_requested();
    for (int slot = matrix.outerIndexPtr()[column]; slot < matrix.outerIndexPtr()[column + 1]; ++slot) {
      const int row = matrix.innerIndexPtr()[slot];
      if (row < column) continue;
      const int a = new_index_[static_cast<std::size_t>(row)];
      const int b = new_index_[static_cast<std::size_t>(column)];
      const int pivot = std::min(a, b);
      const int s = supernode_of[static_cast<std::size_t>(pivot)];
      const Supernode& node = supernodes_[static_cast<std::size_t>(s)];
      const int* list = rows_.data() + node.row_list;
      const auto place = std::lower_bound(list, list + node.rows, std::max(a, b)) - list;
      entries.push_back(
          {s, static_cast<std::int32_t>(place + static_cast<std::int64_t>(pivot - node.first) * node.ld), slot});
    }
  }
  std::vector<std::int64_t> next(count + 1, 0);
  for (const Entry& entry : entries) ++next[static_cast<std::size_t>(entry.supernode) + 1];
  for (std::size_t s = 0; s < count; ++s) next[s + 1] += next[s];
  for (std::size_t s = 0; s <= count; ++s) supernodes_[s].entries = next[s];
  entry_slot_.resize(entries.size());
  entry_place_.resize(entries.size());
  for (const Entry& entry : entries) {
    const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(entry.supernode)]++);
    entry_slot_[at] = entry.slot;
    entry_place_[at] = entry.place;
  }
}

void MultifrontalCholesky::extend_add(const Supernode& child, const double* update, const Supernode& parent,
                                      double* front) const {
  const int below = child.rows - child.pivots;
  const int* relative = relative_.data() + child.relative;
  for (int c = 0; c < below; ++c, update += below) {
    double* column = front + static_cast<std::int64_t>(relative[c]) * parent.ld;
    for (int r = c; r < below; ++r) column[relative[r]] += update[r];
  }
}

bool MultifrontalCholesky::factorize(const SparseMatrix& matrix, double shift) {
  const double* values = matrix.valuePtr();
  const std::size_t count = supernodes_.size() - 1;
  double* top = updates_.data();
  std::vector<int> stack;
  for (std::size_t s = 0; s < count; ++s) {
    cancellation_.throw_if_requested();
    const Supernode& node = supernodes_[s];
    double* front = front_.data();
    std::fill_n(front, static_cast<std::int64_t>(node.ld) * node.rows, 0.0);
    for (std::int64_t e = node.entries; e < supernodes_[s + 1].entries; ++e)
      front[entry_place_[static_cast<std::size_t>(e)]] += values[entry_slot_[static_cast<std::size_t>(e)]];
    for (int k = 0; k < node.pivots; ++k) front[static_cast<std::int64_t>(k) * node.ld + k] += shift;
    while (!stack.empty() && supernodes_[static_cast<std::size_t>(stack.back())].parent == static_cast<int>(s)) {
      const Supernode& child = supernodes_[static_cast<std::size_t>(stack.back())];
      const int below = child.rows - child.pivots;
      top -= static_cast<std::int64_t>(below) * below;
      extend_add(child, top, node, front);
      stack.pop_back();
    }
    if (!partial_cholesky(front, node.ld, node.rows, node.pivots, cancellation_)) {
      cancellation_.throw_if_requested();
      return false;
    }
    std::copy_n(front, static_cast<std::int64_t>(node.ld) * node.pivots, factor_.begin() + node.panel);
    const int below = node.rows - node.pivots;
    if (below == 0) continue;
    for (int c = 0; c < below; ++c, top += below) {
      const double* column = front + static_cast<std::int64_t>(node.pivots + c) * node.ld + node.pivots;
      std::copy(column + c, column + below, top + c);
    }
    stack.push_back(static_cast<int>(s));
  }
  return true;
}

void MultifrontalCholesky::solve_one(double* b) const {
  const std::size_t count = supernodes_.size() - 1;
  Eigen::VectorXd x(n_);
  Eigen::VectorXd below(longest_below());
  for (int i = 0; i < n_; ++i) x[i] = b[old_index_[static_cast<std::size_t>(i)]];
  for (std::size_t s = 0; s < count; ++s) {
    const Supernode& node = supernodes_[s];
    panel_forward_one(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.data() + node.first,
                      below.data());
    const int* list = rows_.data() + node.row_list + node.pivots;
    for (int r = 0; r < node.rows - node.pivots; ++r) x[list[r]] -= below[r];
  }
  for (std::size_t s = count; s-- > 0;) {
    const Supernode& node = supernodes_[s];
    const int* list = rows_.data() + node.row_list + node.pivots;
    for (int r = 0; r < node.rows - node.pivots; ++r) below[r] = x[list[r]];
    panel_backward_one(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.data() + node.first,
                       below.data());
  }
  for (int i = 0; i < n_; ++i) b[old_index_[static_cast<std::size_t>(i)]] = x[i];
}

int MultifrontalCholesky::longest_below() const {
  int longest = 0;
  for (const Supernode& node : supernodes_) longest = std::max(longest, node.rows - node.pivots);
  return longest;
}

void MultifrontalCholesky::solve(Eigen::Ref<Eigen::MatrixXd> b) const {
  if (b.cols() == 1) return solve_one(b.data());
  const std::size_t count = supernodes_.size() - 1;
  // Rows of solve_width numbers, in the new order.
  Eigen::Matrix<double, solve_width, Eigen::Dynamic> x(solve_width, n_);
  Eigen::Matrix<double, solve_width, Eigen::Dynamic> below(solve_width, longest_below());
  for (Eigen::Index begin = 0; begin < b.cols(); begin += solve_width) {
    const auto width = std::min<Eigen::Index>(solve_width, b.cols() - begin);
    x.setZero();
    for (Eigen::Index c = 0; c < width; ++c)
      for (int i = 0; i < n_; ++i) x(c, i) = b(old_index_[static_cast<std::size_t>(i)], begin + c);
    for (std::size_t s = 0; s < count; ++s) {
      const Supernode& node = supernodes_[s];
      panel_forward(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.col(node.first).data(),
                    below.data());
      const int* list = rows_.data() + node.row_list + node.pivots;
      for (int r = 0; r < node.rows - node.pivots; ++r) x.col(list[r]) -= below.col(r);
    }
    for (std::size_t s = count; s-- > 0;) {
      const Supernode& node = supernodes_[s];
      const int* list = rows_.data() + node.row_list + node.pivots;
      for (int r = 0; r < node.rows - node.pivots; ++r) below.col(r) = x.col(list[r]);
      panel_backward(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.col(node.first).data(),
                     below.data());
    }
    for (Eigen::Index c = 0; c < width; ++c)
      for (int i = 0; i < n_; ++i) b(old_index_[static_cast<std::size_t>(i)], begin + c) = x(c, i);
  }
}

}  // namespace supple::numerics
