#include "multifrontal_cholesky.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>

#include "partial_cholesky.h"
#include "supple/base/threads.h"
#include "symbolic_analysis.h"

namespace supple::numerics {
namespace {

/// The ordering is computed anew once the factor has this many times the entries that it had with its own pattern.
constexpr double max_reordering_ratio = 1.3;
/// The supernodes are computed anew once the panels have this many times the entries that they had at first.
constexpr double max_regrouping_ratio = 1.1;
/// Patterns of fewer unknowns are always analysed anew, which takes CHOLMOD less than a millisecond.
constexpr int min_unknowns_for_reuse = 1000;

/// Multiply-adds from which on several threads are used: some milliseconds.
constexpr double min_parallel_work = 1e7;
/// Limits of a subtree's work, as fractions of the total. A subtree above the first is divided. One below the second is
/// factorized together with the supernodes above it.
constexpr double max_subtree_fraction = 0.1;
constexpr double min_subtree_fraction = 0.002;

/// Number of columns of a front that one task processes, and number of columns from which on tasks are used.
constexpr int columns_per_task = 64;
constexpr int min_parallel_columns = 512;

/// Calls body(first, end) for all columns at once or, if there are many, in parallel for groups of columns.
template <class Body>
void for_columns(int columns, const Body& body) {
  if (columns < min_parallel_columns) return body(0, columns);
  parallel_for((columns + columns_per_task - 1) / columns_per_task,
               [&](int part) { body(part * columns_per_task, std::min(columns, (part + 1) * columns_per_task)); });
}

/// Rounds up to a multiple of four rows, so that all columns of a panel have the same alignment.
int padded(int rows) { return (rows + 3) / 4 * 4; }

}  // namespace

void MultifrontalCholesky::analyze(const SparseMatrix& matrix) {
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
  front_entries_ = static_cast<std::int64_t>(factor_.size());
}

void MultifrontalCholesky::set_order(std::vector<int> old_index) {
  old_index_ = std::move(old_index);
  new_index_.resize(static_cast<std::size_t>(n_));
  for (int i = 0; i < n_; ++i) new_index_[static_cast<std::size_t>(old_index_[static_cast<std::size_t>(i)])] = i;
}

void MultifrontalCholesky::set_fronts(const Fronts& fronts) {
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
  cancellation_.throw_if_requested();
  discard_and_resize(factor_, static_cast<std::size_t>(panel));
  find_relative_rows();
  choose_subtrees();
  allocate_workspaces();
  cancellation_.throw_if_requested();
  locate_entries();
}

void MultifrontalCholesky::group_entries(const SparseMatrix& matrix, const std::vector<int>& first) {
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
std::optional<MultifrontalCholesky::Fronts> MultifrontalCholesky::fronts_of_same_supernodes() const {
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
    if (static_cast<double>(entries) > max_regrouping_ratio * static_cast<double>(front_entries_)) return std::nullopt;
  }
  fronts.first.push_back(n_);
  return fronts;
}

/// Sorts supernodes into postorder, so that children come directly before their parents: update matrices are on a
/// stack. New entries may have given a supernode another parent. Changes the numbers of columns and rows, and returns
/// true, if the order has changed.
bool MultifrontalCholesky::sort_into_postorder(Fronts& fronts) {
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

void MultifrontalCholesky::find_relative_rows() {
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

/// Approximate number of multiply-adds of a supernode's factorization.
double MultifrontalCholesky::operations(const Supernode& node) {
  return 0.5 * static_cast<double>(node.pivots) * node.rows * node.rows;
}

/// Divides the largest subtrees into their children until none has more than max_subtree_fraction of the work. The
/// result does not depend on the number of threads.
void MultifrontalCholesky::choose_subtrees() {
  const auto count = static_cast<int>(supernodes_.size()) - 1;
  std::vector<double> work(static_cast<std::size_t>(count), 0);  // of each supernode's subtree
  std::vector<int> begin(static_cast<std::size_t>(count));       // first supernode of each one's subtree
  for (int s = 0; s < count; ++s) begin[static_cast<std::size_t>(s)] = s;
  double total = 0;
  // First child of each supernode; `sibling` is the next child of the same parent.
  std::vector<int> child(static_cast<std::size_t>(count), -1);
  std::vector<int> sibling(static_cast<std::size_t>(count), -1);
  std::vector<std::pair<double, int>> heap;  // pairs of a subtree's work and its root
  for (int s = 0; s < count; ++s) {
    const auto s_index = static_cast<std::size_t>(s);
    const Supernode& node = supernodes_[s_index];
    work[s_index] += operations(node);
    total += operations(node);
    if (node.parent < 0) {
      heap.emplace_back(work[s_index], s);
      continue;
    }
    const auto parent = static_cast<std::size_t>(node.parent);
    work[parent] += work[s_index];
    begin[parent] = std::min(begin[parent], begin[s_index]);
    sibling[s_index] = child[parent];
    child[parent] = s;
  }
  subtrees_.clear();
  if (total < min_parallel_work) return;
  std::make_heap(heap.begin(), heap.end());
  while (!heap.empty() && heap.front().first > total * max_subtree_fraction) {
    std::pop_heap(heap.begin(), heap.end());
    const int root = heap.back().second;
    heap.pop_back();
    for (int c = child[static_cast<std::size_t>(root)]; c >= 0; c = sibling[static_cast<std::size_t>(c)]) {
      heap.emplace_back(work[static_cast<std::size_t>(c)], c);
      std::push_heap(heap.begin(), heap.end());
    }
  }
  std::sort(heap.begin(), heap.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  for (const auto& [subtree_work, root] : heap)
    if (subtree_work > total * min_subtree_fraction)
      subtrees_.push_back({begin[static_cast<std::size_t>(root)], root, {}});
}

/// The memory for the supernodes from `begin` up to `end`, which are whole subtrees, except those in `excluded`.
MultifrontalCholesky::WorkspaceSize MultifrontalCholesky::workspace_size(int begin, int end,
                                                                         const std::vector<Subtree>& excluded) const {
  WorkspaceSize size;
  std::size_t stacked = 0;
  // Size of the update matrices of each one's children.
  std::vector<std::size_t> child_updates(static_cast<std::size_t>(end - begin), 0);
  auto subtree = excluded.begin();
  for (int s = begin; s < end; ++s) {
    if (subtree != excluded.end() && s == subtree->begin) {
      s = subtree->root;
      ++subtree;
      continue;
    }
    const Supernode& node = supernodes_[static_cast<std::size_t>(s)];
    size.front = std::max(size.front, static_cast<std::size_t>(node.ld) * static_cast<std::size_t>(node.rows));
    stacked -= child_updates[static_cast<std::size_t>(s - begin)];
    const auto below = static_cast<std::size_t>(node.rows - node.pivots);
    if (node.parent >= 0 && node.parent < end)
      child_updates[static_cast<std::size_t>(node.parent - begin)] += below * below;
    stacked += below * below;
    size.stacked = std::max(size.stacked, stacked);
  }
  return size;
}

void MultifrontalCholesky::allocate_workspaces() {
  const WorkspaceSize upper = workspace_size(0, static_cast<int>(supernodes_.size()) - 1, subtrees_);
  discard_and_resize(workspace_.front, upper.front);
  discard_and_resize(workspace_.updates, upper.stacked);
  subtree_workspace_ = {};
  for (const Subtree& subtree : subtrees_) {
    const WorkspaceSize size = workspace_size(subtree.begin, subtree.root + 1, {});
    subtree_workspace_ = {std::max(subtree_workspace_.front, size.front),
                          std::max(subtree_workspace_.stacked, size.stacked)};
  }
}

void MultifrontalCholesky::locate_entries() {
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

void MultifrontalCholesky::extend_add(const Supernode& child, const double* update, const Supernode& parent,
                                      double* front) const {
  const int below = child.rows - child.pivots;
  const int* relative = relative_.data() + child.relative;
  for_columns(below, [&](int first, int end) {
    for (int c = first; c < end; ++c) {
      const double* from = update + static_cast<std::int64_t>(c) * below;
      double* column = front + static_cast<std::int64_t>(relative[c]) * parent.ld;
      for (int r = c; r < below; ++r) column[relative[r]] += from[r];
    }
  });
}

/// Assembles the front and factorizes its pivots. Writes the update matrix to `top`, and moves `top` past it.
bool MultifrontalCholesky::factorize_supernode(int number, const SparseMatrix& matrix, double shift,
                                               Workspace& workspace, double*& top,
                                               std::vector<PendingUpdate>& pending) {
  cancellation_.throw_if_requested();
  const Supernode& node = supernodes_[static_cast<std::size_t>(number)];
  const double* values = matrix.valuePtr();
  double* front = workspace.front.data();
  // Only lower triangles are read.
  for_columns(node.rows, [&](int first, int end) {
    for (int c = first; c < end; ++c) std::fill_n(front + static_cast<std::int64_t>(c) * node.ld + c, node.ld - c, 0.0);
  });
  for (std::int64_t e = node.entries; e < supernodes_[static_cast<std::size_t>(number) + 1].entries; ++e)
    front[entry_position_[static_cast<std::size_t>(e)]] += values[entry_slot_[static_cast<std::size_t>(e)]];
  for (int k = 0; k < node.pivots; ++k) front[static_cast<std::int64_t>(k) * node.ld + k] += shift;
  while (!pending.empty() && supernodes_[static_cast<std::size_t>(pending.back().supernode)].parent == number) {
    const Supernode& child = supernodes_[static_cast<std::size_t>(pending.back().supernode)];
    const int below = child.rows - child.pivots;
    if (pending.back().on_stack) top -= static_cast<std::int64_t>(below) * below;
    extend_add(child, pending.back().update, node, front);
    pending.pop_back();
  }
  if (!partial_cholesky(front, node.ld, node.rows, node.pivots, cancellation_)) {
    cancellation_.throw_if_requested();
    return false;
  }
  for_columns(node.pivots, [&](int first, int end) {
    const auto begin = static_cast<std::int64_t>(node.ld) * first;
    std::copy_n(front + begin, static_cast<std::int64_t>(node.ld) * (end - first), factor_.data() + node.panel + begin);
  });
  const int below = node.rows - node.pivots;
  if (below == 0) return true;
  pending.push_back({number, top, true});
  for_columns(below, [&](int first, int end) {
    for (int c = first; c < end; ++c) {
      const double* column = front + static_cast<std::int64_t>(node.pivots + c) * node.ld + node.pivots;
      std::copy(column + c, column + below, top + static_cast<std::int64_t>(c) * below + c);
    }
  });
  top += static_cast<std::int64_t>(below) * below;
  return true;
}

bool MultifrontalCholesky::factorize_subtree(const SparseMatrix& matrix, double shift, Subtree& subtree,
                                             Workspace& workspace) {
  double* top = workspace.updates.data();
  std::vector<PendingUpdate> pending;
  for (int s = subtree.begin; s <= subtree.root; ++s)
    if (!factorize_supernode(s, matrix, shift, workspace, top, pending)) return false;
  subtree.update.assign(workspace.updates.data(), top);
  return true;
}

/// Factorizes the supernodes that are in no subtree, one after the other.
bool MultifrontalCholesky::factorize_upper(const SparseMatrix& matrix, double shift) {
  const int count = static_cast<int>(supernodes_.size()) - 1;
  double* top = workspace_.updates.data();
  std::vector<PendingUpdate> pending;
  auto subtree = subtrees_.begin();
  for (int s = 0; s < count; ++s) {
    if (subtree != subtrees_.end() && s == subtree->begin) {
      s = subtree->root;
      if (supernodes_[static_cast<std::size_t>(s)].parent >= 0) pending.push_back({s, subtree->update.data(), false});
      ++subtree;
    } else if (!factorize_supernode(s, matrix, shift, workspace_, top, pending)) {
      return false;
    }
  }
  return true;
}

bool MultifrontalCholesky::factorize(const SparseMatrix& matrix, double shift) {
  std::atomic<bool> definite = true;
  if (!subtrees_.empty()) {
    std::mutex workspaces_mutex;
    parallel_for(static_cast<int>(subtrees_.size()), [&](int number) {
      if (!definite) return;
      Workspace workspace;
      {
        const std::lock_guard lock(workspaces_mutex);
        if (!idle_workspaces_.empty()) {
          workspace = std::move(idle_workspaces_.back());
          idle_workspaces_.pop_back();
        }
      }
      discard_and_resize(workspace.front, subtree_workspace_.front);
      discard_and_resize(workspace.updates, subtree_workspace_.stacked);
      if (!factorize_subtree(matrix, shift, subtrees_[static_cast<std::size_t>(number)], workspace)) definite = false;
      const std::lock_guard lock(workspaces_mutex);
      idle_workspaces_.push_back(std::move(workspace));
    });
  }
  return definite && factorize_upper(matrix, shift);
}

void MultifrontalCholesky::solve_one(double* b) const {
  const std::size_t count = supernodes_.size() - 1;
  Eigen::VectorXd x(n_);
  Eigen::VectorXd below(max_update_rows());
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

int MultifrontalCholesky::max_update_rows() const {
  int longest = 0;
  for (const Supernode& node : supernodes_) longest = std::max(longest, node.rows - node.pivots);
  return longest;
}

void MultifrontalCholesky::solve(Eigen::Ref<Eigen::MatrixXd> b) const {
  if (b.cols() == 1) return solve_one(b.data());
  const std::size_t count = supernodes_.size() - 1;
  // Columns of solve_width numbers, one for each unknown in the new order.
  Eigen::Matrix<double, solve_width, Eigen::Dynamic> x(solve_width, n_);
  Eigen::Matrix<double, solve_width, Eigen::Dynamic> below(solve_width, max_update_rows());
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
