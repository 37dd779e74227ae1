#include "front_tree.h"

#include <algorithm>
#include <utility>

namespace supple::numerics {
namespace {

/// The ordering is computed anew once the factor has this many times the entries that it had with its own pattern.
constexpr double max_reordering_ratio = 1.3;
/// The supernodes are computed anew once the panels have this many times the entries that they had at first.
constexpr double max_regrouping_ratio = 1.1;
/// Patterns of fewer unknowns are always analysed anew, which takes CHOLMOD less than a millisecond.
constexpr int min_unknowns_for_reuse = 1000;

/// Rounds up to a multiple of four rows, so that all columns of a panel have the same alignment.
int padded(int rows) { return (rows + 3) / 4 * 4; }

}  // namespace

void FrontTree::analyze(const SparseMatrix& matrix) {
  // A few new entries, e.g. of contacts, or of geodesics across other faces, hardly change the best supernodes and the
  // best ordering. Computing these anew would cost more than some factorizations.
  if (n_ == matrix.rows() && n_ >= min_unknowns_for_reuse) {
    std::vector<int> first;
    for (const Supernode& node : supernodes_) first.push_back(node.first);
    group_entries(matrix, first);
    if (std::optional<Fronts> fronts = fronts_of_same_supernodes()) {
      if (sort_into_postorder(*fronts)) group_entries(matrix, fronts->first);
      set_fronts(*fronts);
      return;
    }
  }
  std::vector<int> known_ordering;
  if (n_ == matrix.rows()) known_ordering = old_index_;
  SymbolicAnalysis analysis = analyse(matrix, known_ordering, cancellation_, search_);
  if (!known_ordering.empty() && analysis.entries > max_reordering_ratio * best_entries_)
    analysis = analyse(matrix, {}, cancellation_, search_);
  if (known_ordering.empty() || analysis.entries < best_entries_) best_entries_ = analysis.entries;
  n_ = static_cast<int>(matrix.rows());
  set_order(std::move(analysis.old_index));
  group_entries(matrix, analysis.first);
  set_fronts({std::move(analysis.first), std::move(analysis.row_begin), std::move(analysis.rows)});
  first_panel_entries_ = panel_entries_;
}

void FrontTree::set_order(std::vector<int> old_index) {
  old_index_ = std::move(old_index);
  new_index_.resize(static_cast<std::size_t>(n_));
  for (int i = 0; i < n_; ++i) new_index_[static_cast<std::size_t>(old_index_[static_cast<std::size_t>(i)])] = i;
}

void FrontTree::set_fronts(const Fronts& fronts) {
  const std::vector<int>& first = fronts.first;
  const std::size_t count = first.size() - 1;
  rows_ = fronts.rows;
  supernodes_.assign(count + 1, {});
  std::int64_t panel = 0;
  std::int64_t relative = 0;
  for (std::size_t s = 0; s < count; ++s) {
    Supernode& node = supernodes_[s];
    node.first = first[s];
    node.pivots = first[s + 1] - first[s];
    node.rows = fronts.row_begin[s + 1] - fronts.row_begin[s];
    node.ld = padded(node.rows);
    node.row_list = fronts.row_begin[s];
    node.panel = panel;
    node.relative = relative;
    panel += static_cast<std::int64_t>(node.ld) * node.pivots;
    relative += node.rows - node.pivots;
  }
  supernodes_[count].first = n_;
  panel_entries_ = panel;
  cancellation_.throw_if_requested();
  find_relative_rows();
  cancellation_.throw_if_requested();
  locate_entries();
}

void FrontTree::group_entries(const SparseMatrix& matrix, const std::vector<int>& first) {
  const std::size_t count = first.size() - 1;
  supernode_of_.resize(static_cast<std::size_t>(n_));
  for (std::size_t s = 0; s < count; ++s)
    std::fill(supernode_of_.begin() + first[s], supernode_of_.begin() + first[s + 1], static_cast<int>(s));
  constexpr int columns_between_checks = 1 << 15;
  const auto for_each_entry = [&](const auto& visit) {
    for (int column = 0; column < n_; ++column) {
      if (column % columns_between_checks == 0) cancellation_.throw_if_requested();
      const int b = new_index_[static_cast<std::size_t>(column)];
      for (int slot = matrix.outerIndexPtr()[column]; slot < matrix.outerIndexPtr()[column + 1]; ++slot) {
        const int row = matrix.innerIndexPtr()[slot];
        if (row < column) continue;
        const int a = new_index_[static_cast<std::size_t>(row)];
        visit(std::min(a, b), std::max(a, b), slot);
      }
    }
  };
  const auto supernode_of = [&](int pivot) {
    return static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(pivot)]);
  };
  entry_begin_.assign(count + 1, 0);
  for_each_entry([&](int pivot, int, int) { ++entry_begin_[supernode_of(pivot) + 1]; });
  for (std::size_t s = 0; s < count; ++s) entry_begin_[s + 1] += entry_begin_[s];
  std::vector<std::int64_t> next(entry_begin_.begin(), entry_begin_.end() - 1);
  entries_.resize(static_cast<std::size_t>(entry_begin_.back()));
  for_each_entry([&](int pivot, int row, int slot) {
    entries_[static_cast<std::size_t>(next[supernode_of(pivot)]++)] = {pivot, row, slot};
  });
}

/// The fronts of the grouped entries, with the old supernodes. The rows of a supernode are its pivots, those of its
/// entries, and those of its children's update matrices. Empty if the panels have grown too much.
std::optional<FrontTree::Fronts> FrontTree::fronts_of_same_supernodes() const {
  const std::size_t count = supernodes_.size() - 1;
  Fronts fronts;
  fronts.row_begin.push_back(0);
  fronts.rows.reserve(rows_.size());
  std::vector<int> last_marked_by(static_cast<std::size_t>(n_), -1);
  std::vector<int> child(count, -1);  // first child of each supernode; `sibling` is the next child of the same parent
  std::vector<int> sibling(count, -1);
  std::int64_t entries = 0;
  for (std::size_t s = 0; s < count; ++s) {
    if (s % 1024 == 0) cancellation_.throw_if_requested();
    const int begin = supernodes_[s].first;
    const int end = supernodes_[s + 1].first;
    fronts.first.push_back(begin);
    for (int k = begin; k < end; ++k) fronts.rows.push_back(k);
    const std::size_t below = fronts.rows.size();
    const auto add_row = [&](int row) {
      if (row < end || last_marked_by[static_cast<std::size_t>(row)] == static_cast<int>(s)) return;
      last_marked_by[static_cast<std::size_t>(row)] = static_cast<int>(s);
      fronts.rows.push_back(row);
    };
    for (std::int64_t e = entry_begin_[s]; e < entry_begin_[s + 1]; ++e)
      add_row(entries_[static_cast<std::size_t>(e)].row);
    for (int c = child[s]; c >= 0; c = sibling[static_cast<std::size_t>(c)]) {
      const auto child_index = static_cast<std::size_t>(c);
      const int pivots = supernodes_[child_index + 1].first - supernodes_[child_index].first;
      for (int r = fronts.row_begin[child_index] + pivots; r < fronts.row_begin[child_index + 1]; ++r)
        add_row(fronts.rows[static_cast<std::size_t>(r)]);
    }
    std::sort(fronts.rows.begin() + static_cast<std::ptrdiff_t>(below), fronts.rows.end());
    if (fronts.rows.size() > below) {
      const auto parent = static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(fronts.rows[below])]);
      sibling[s] = child[parent];
      child[parent] = static_cast<int>(s);
    }
    const auto rows = static_cast<int>(fronts.rows.size());
    entries += static_cast<std::int64_t>(padded(rows - fronts.row_begin.back())) * (end - begin);
    fronts.row_begin.push_back(rows);
    if (static_cast<double>(entries) > max_regrouping_ratio * static_cast<double>(first_panel_entries_))
      return std::nullopt;
  }
  fronts.first.push_back(n_);
  return fronts;
}

/// Sorts supernodes into postorder, so that children come directly before their parents: update matrices are on a
/// stack. New entries may have given a supernode another parent. Changes the numbers of columns and rows, and returns
/// true, if the order has changed.
bool FrontTree::sort_into_postorder(Fronts& fronts) {
  const std::size_t count = fronts.first.size() - 1;
  const auto pivots_of = [&](std::size_t s) { return fronts.first[s + 1] - fronts.first[s]; };
  std::vector<int> child(count, -1);
  std::vector<int> sibling(count, -1);
  std::vector<int> roots;
  for (std::size_t s = count; s-- > 0;) {
    const int below = fronts.row_begin[s] + pivots_of(s);
    if (below == fronts.row_begin[s + 1]) {
      roots.push_back(static_cast<int>(s));
      continue;
    }
    const auto parent =
        static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(fronts.rows[static_cast<std::size_t>(below)])]);
    sibling[s] = child[parent];
    child[parent] = static_cast<int>(s);
  }
  std::vector<std::size_t> order;
  order.reserve(count);
  std::vector<int> to_visit(roots);  // a stack; the first root is on top
  while (!to_visit.empty()) {
    const int s = to_visit.back();
    const int c = child[static_cast<std::size_t>(s)];
    if (c >= 0) {
      child[static_cast<std::size_t>(s)] = sibling[static_cast<std::size_t>(c)];
      to_visit.push_back(c);
      continue;
    }
    order.push_back(static_cast<std::size_t>(s));
    to_visit.pop_back();
  }
  if (std::is_sorted(order.begin(), order.end())) return false;
  std::vector<int> new_column(static_cast<std::size_t>(n_));  // the new number of each column
  Fronts sorted;
  for (int next = 0; const std::size_t s : order) {
    sorted.first.push_back(next);
    for (int k = fronts.first[s]; k < fronts.first[s + 1]; ++k) new_column[static_cast<std::size_t>(k)] = next++;
  }
  sorted.first.push_back(n_);
  sorted.row_begin.push_back(0);
  sorted.rows.reserve(fronts.rows.size());
  for (const std::size_t s : order) {
    const auto begin = static_cast<std::ptrdiff_t>(sorted.rows.size());
    for (int r = fronts.row_begin[s]; r < fronts.row_begin[s + 1]; ++r)
      sorted.rows.push_back(new_column[static_cast<std::size_t>(fronts.rows[static_cast<std::size_t>(r)])]);
    std::sort(sorted.rows.begin() + begin, sorted.rows.end());
    sorted.row_begin.push_back(static_cast<int>(sorted.rows.size()));
  }
  std::vector<int> old_index(static_cast<std::size_t>(n_));
  for (int i = 0; i < n_; ++i)
    old_index[static_cast<std::size_t>(new_column[static_cast<std::size_t>(i)])] =
        old_index_[static_cast<std::size_t>(i)];
  set_order(std::move(old_index));
  fronts = std::move(sorted);
  return true;
}

void FrontTree::find_relative_rows() {
  const std::size_t count = supernodes_.size() - 1;
  relative_.clear();
  for (std::size_t s = 0; s < count; ++s) {
    Supernode& node = supernodes_[s];
    const int below = node.rows - node.pivots;
    if (below == 0) continue;
    const int* list = rows_.data() + node.row_list + node.pivots;
    node.parent = supernode_of_[static_cast<std::size_t>(list[0])];
    const Supernode& parent = supernodes_[static_cast<std::size_t>(node.parent)];
    const int* at = rows_.data() + parent.row_list;
    int position = 0;
    for (int r = 0; r < below; ++r) {
      while (at[position] != list[r]) ++position;
      relative_.push_back(position);
    }
  }
}

void FrontTree::locate_entries() {
  const std::size_t count = supernodes_.size() - 1;
  entry_slot_.resize(entries_.size());
  entry_position_.resize(entries_.size());
  std::vector<int> position_of(static_cast<std::size_t>(n_));  // position of each row in the current front
  for (std::size_t s = 0; s < count; ++s) {
    Supernode& node = supernodes_[s];
    node.entries = entry_begin_[s];
    const int* list = rows_.data() + node.row_list;
    for (int r = 0; r < node.rows; ++r) position_of[static_cast<std::size_t>(list[r])] = r;
    for (std::int64_t e = entry_begin_[s]; e < entry_begin_[s + 1]; ++e) {
      const auto at = static_cast<std::size_t>(e);
      const Entry& entry = entries_[at];
      entry_slot_[at] = entry.slot;
      entry_position_[at] = static_cast<std::int32_t>(position_of[static_cast<std::size_t>(entry.row)] +
                                                      static_cast<std::int64_t>(entry.pivot - node.first) * node.ld);
    }
  }
  supernodes_[count].entries = entry_begin_[count];
  entries_ = std::vector<Entry>();
}

int FrontTree::max_update_rows() const {
  int longest = 0;
  for (const Supernode& node : supernodes_) longest = std::max(longest, node.rows - node.pivots);
  return longest;
}

}  // namespace supple::numerics
