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

/// A known ordering is given up once the factor has this many times the entries it had with its own pattern.
constexpr double worth_reordering = 1.3;
/// Supernodes are given up once their fronts have this many times the entries they had when they were made.
constexpr double worth_regrouping = 1.1;
/// Patterns of fewer unknowns are analysed anew: that takes CHOLMOD less than a millisecond.
constexpr int unknowns_worth_keeping = 1000;

/// Multiply-adds that are worth more than one thread: some milliseconds.
constexpr double work_worth_sharing = 1e7;
/// Shares of the whole work: no subtree that a thread takes has more than the first, and one that has less than the
/// second is done together with what is above it.
constexpr double largest_share = 0.1;
constexpr double smallest_share = 0.002;

/// Columns of a front whose numbers one thread moves at a time, and the rows of a front that is worth that.
constexpr int columns_at_a_time = 64;
constexpr int rows_worth_sharing = 512;

/// Calls body(first, end) for all columns in order, or for some at a time by all threads where the matrix of so many
/// columns is large.
template <class Body>
void for_columns(int columns, const Body& body) {
  if (columns < rows_worth_sharing) return body(0, columns);
  parallel_for((columns + columns_at_a_time - 1) / columns_at_a_time,
               [&](int part) { body(part * columns_at_a_time, std::min(columns, (part + 1) * columns_at_a_time)); });
}

/// A multiple of four rows: every column of a panel then starts at the same alignment.
int padded(int rows) { return (rows + 3) / 4 * 4; }

}  // namespace

void MultifrontalCholesky::analyze(const SparseMatrix& matrix) {
  // A few more places, as contacts and paths over other faces bring them, change the best supernodes and the best
  // ordering little; finding these anew costs more than some factorizations.
  if (n_ == matrix.rows() && n_ >= unknowns_worth_keeping) {
    std::vector<int> first;
    for (const Supernode& node : supernodes_) first.push_back(node.first);
    group_entries(matrix, first);
    if (std::optional<Fronts> fronts = fronts_of_same_supernodes()) {
      if (sort_into_postorder(*fronts)) group_entries(matrix, fronts->first);
      set_fronts(*fronts);
      return;
    }
  }
  std::vector<int> known;
  if (n_ == matrix.rows()) known = old_index_;
  SymbolicAnalysis analysis = analyse(matrix, known, cancellation_, search_);
  if (!known.empty() && analysis.entries > worth_reordering * best_entries_)
    analysis = analyse(matrix, {}, cancellation_, search_);
  if (known.empty() || analysis.entries < best_entries_) best_entries_ = analysis.entries;
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
  make_room(factor_, static_cast<std::size_t>(panel));
  find_relative_rows();
  choose_subtrees();
  size_rooms();
  cancellation_.throw_if_requested();
  place_entries();
}

void MultifrontalCholesky::group_entries(const SparseMatrix& matrix, const std::vector<int>& first) {
  const std::size_t count = first.size() - 1;
  supernode_of_.resize(static_cast<std::size_t>(n_));
  for (std::size_t s = 0; s < count; ++s)
    std::fill(supernode_of_.begin() + first[s], supernode_of_.begin() + first[s + 1], static_cast<int>(s));
  constexpr int columns_between_looks = 1 << 15;
  const auto for_each_entry = [&](const auto& take) {
    for (int column = 0; column < n_; ++column) {
      if (column % columns_between_looks == 0) cancellation_.throw_if_requested();
      const int b = new_index_[static_cast<std::size_t>(column)];
      for (int slot = matrix.outerIndexPtr()[column]; slot < matrix.outerIndexPtr()[column + 1]; ++slot) {
        const int row = matrix.innerIndexPtr()[slot];
        if (row < column) continue;
        const int a = new_index_[static_cast<std::size_t>(row)];
        take(std::min(a, b), std::max(a, b), slot);
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

/// The fronts of the grouped entries: the rows of each supernode are its pivots, those of its entries and those that
/// its children hand on. Nothing where they have grown too much.
std::optional<MultifrontalCholesky::Fronts> MultifrontalCholesky::fronts_of_same_supernodes() const {
  const std::size_t count = supernodes_.size() - 1;
  Fronts fronts;
  fronts.row_begin.push_back(0);
  fronts.rows.reserve(rows_.size());
  std::vector<int> seen_by(static_cast<std::size_t>(n_), -1);
  std::vector<int> child(count, -1);  // a child of each, and the next one of the same parent
  std::vector<int> sibling(count, -1);
  std::int64_t entries = 0;
  for (std::size_t s = 0; s < count; ++s) {
    if (s % 1024 == 0) cancellation_.throw_if_requested();
    const int begin = supernodes_[s].first;
    const int end = supernodes_[s + 1].first;
    fronts.first.push_back(begin);
    for (int k = begin; k < end; ++k) fronts.rows.push_back(k);
    const std::size_t below = fronts.rows.size();
    const auto take = [&](int row) {
      if (row < end || seen_by[static_cast<std::size_t>(row)] == static_cast<int>(s)) return;
      seen_by[static_cast<std::size_t>(row)] = static_cast<int>(s);
      fronts.rows.push_back(row);
    };
    for (std::int64_t e = entry_begin_[s]; e < entry_begin_[s + 1]; ++e)
      take(entries_[static_cast<std::size_t>(e)].row);
    for (int c = child[s]; c >= 0; c = sibling[static_cast<std::size_t>(c)]) {
      const auto own = static_cast<std::size_t>(c);
      const int pivots = supernodes_[own + 1].first - supernodes_[own].first;
      for (int r = fronts.row_begin[own] + pivots; r < fronts.row_begin[own + 1]; ++r)
        take(fronts.rows[static_cast<std::size_t>(r)]);
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
    if (static_cast<double>(entries) > worth_regrouping * static_cast<double>(front_entries_)) return std::nullopt;
  }
  fronts.first.push_back(n_);
  return fronts;
}

/// What supernodes hand on waits on a stack: children come right before their parents. New places may give a supernode
/// another parent; the order then changes, and with it the numbers of columns and rows. Whether it did.
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
  std::vector<int> waiting(roots);  // the first root is the last
  while (!waiting.empty()) {
    const int s = waiting.back();
    const int c = child[static_cast<std::size_t>(s)];
    if (c >= 0) {
      child[static_cast<std::size_t>(s)] = sibling[static_cast<std::size_t>(c)];
      waiting.push_back(c);
      continue;
    }
    order.push_back(static_cast<std::size_t>(s));
    waiting.pop_back();
  }
  if (std::is_sorted(order.begin(), order.end())) return false;
  std::vector<int> moved(static_cast<std::size_t>(n_));  // the new number of each column
  Fronts sorted;
  for (int next = 0; const std::size_t s : order) {
    sorted.first.push_back(next);
    for (int k = fronts.first[s]; k < fronts.first[s + 1]; ++k) moved[static_cast<std::size_t>(k)] = next++;
  }
  sorted.first.push_back(n_);
  sorted.row_begin.push_back(0);
  sorted.rows.reserve(fronts.rows.size());
  for (const std::size_t s : order) {
    const auto begin = static_cast<std::ptrdiff_t>(sorted.rows.size());
    for (int r = fronts.row_begin[s]; r < fronts.row_begin[s + 1]; ++r)
      sorted.rows.push_back(moved[static_cast<std::size_t>(fronts.rows[static_cast<std::size_t>(r)])]);
    std::sort(sorted.rows.begin() + begin, sorted.rows.end());
    sorted.row_begin.push_back(static_cast<int>(sorted.rows.size()));
  }
  std::vector<int> old_index(static_cast<std::size_t>(n_));
  for (int i = 0; i < n_; ++i)
    old_index[static_cast<std::size_t>(moved[static_cast<std::size_t>(i)])] = old_index_[static_cast<std::size_t>(i)];
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
    int place = 0;
    for (int r = 0; r < below; ++r) {
      while (at[place] != list[r]) ++place;
      relative_.push_back(place);
    }
  }
}

/// Multiply-adds of a supernode's factorization, roughly.
double MultifrontalCholesky::work_of(const Supernode& node) {
  return 0.5 * static_cast<double>(node.pivots) * node.rows * node.rows;
}

/// Divides the largest subtree into its children until there are enough of about the same work for all threads. The
/// number of threads changes nothing.
void MultifrontalCholesky::choose_subtrees() {
  const auto count = static_cast<int>(supernodes_.size()) - 1;
  std::vector<double> work(static_cast<std::size_t>(count), 0);  // of the subtree of each
  std::vector<int> begin(static_cast<std::size_t>(count));       // its first supernode
  for (int s = 0; s < count; ++s) begin[static_cast<std::size_t>(s)] = s;
  double whole = 0;
  std::vector<int> child(static_cast<std::size_t>(count), -1);  // a child of each, and the next one of the same parent
  std::vector<int> sibling(static_cast<std::size_t>(count), -1);
  std::vector<std::pair<double, int>> heap;  // of work and root
  for (int s = 0; s < count; ++s) {
    const auto own = static_cast<std::size_t>(s);
    const Supernode& node = supernodes_[own];
    work[own] += work_of(node);
    whole += work_of(node);
    if (node.parent < 0) {
      heap.emplace_back(work[own], s);
      continue;
    }
    const auto parent = static_cast<std::size_t>(node.parent);
    work[parent] += work[own];
    begin[parent] = std::min(begin[parent], begin[own]);
    sibling[own] = child[parent];
    child[parent] = s;
  }
  subtrees_.clear();
  if (whole < work_worth_sharing) return;
  std::make_heap(heap.begin(), heap.end());
  while (!heap.empty() && heap.front().first > whole * largest_share) {
    std::pop_heap(heap.begin(), heap.end());
    const int root = heap.back().second;
    heap.pop_back();
    for (int c = child[static_cast<std::size_t>(root)]; c >= 0; c = sibling[static_cast<std::size_t>(c)]) {
      heap.emplace_back(work[static_cast<std::size_t>(c)], c);
      std::push_heap(heap.begin(), heap.end());
    }
  }
  std::sort(heap.begin(), heap.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  for (const auto& [amount, root] : heap)
    if (amount > whole * smallest_share) subtrees_.push_back({begin[static_cast<std::size_t>(root)], root, {}});
}

/// The room for the supernodes from `begin` up to `end`, whole subtrees, without those that are subtrees of their own.
MultifrontalCholesky::RoomSize MultifrontalCholesky::room_for(int begin, int end,
                                                              const std::vector<Subtree>& without) const {
  RoomSize size;
  std::size_t stacked = 0;
  std::vector<std::size_t> waiting(static_cast<std::size_t>(end - begin), 0);  // for each, of its children
  auto subtree = without.begin();
  for (int s = begin; s < end; ++s) {
    if (subtree != without.end() && s == subtree->begin) {
      s = subtree->root;
      ++subtree;
      continue;
    }
    const Supernode& node = supernodes_[static_cast<std::size_t>(s)];
    size.front = std::max(size.front, static_cast<std::size_t>(node.ld) * static_cast<std::size_t>(node.rows));
    stacked -= waiting[static_cast<std::size_t>(s - begin)];
    const auto below = static_cast<std::size_t>(node.rows - node.pivots);
    if (node.parent >= 0 && node.parent < end) waiting[static_cast<std::size_t>(node.parent - begin)] += below * below;
    stacked += below * below;
    size.stacked = std::max(size.stacked, stacked);
  }
  return size;
}

void MultifrontalCholesky::size_rooms() {
  const RoomSize upper = room_for(0, static_cast<int>(supernodes_.size()) - 1, subtrees_);
  make_room(room_.front, upper.front);
  make_room(room_.updates, upper.stacked);
  of_subtrees_ = {};
  for (const Subtree& subtree : subtrees_) {
    const RoomSize size = room_for(subtree.begin, subtree.root + 1, {});
    of_subtrees_ = {std::max(of_subtrees_.front, size.front), std::max(of_subtrees_.stacked, size.stacked)};
  }
}

void MultifrontalCholesky::place_entries() {
  const std::size_t count = supernodes_.size() - 1;
  entry_slot_.resize(entries_.size());
  entry_place_.resize(entries_.size());
  std::vector<int> place_of(static_cast<std::size_t>(n_));  // of each row in the front at hand
  for (std::size_t s = 0; s < count; ++s) {
    Supernode& node = supernodes_[s];
    node.entries = entry_begin_[s];
    const int* list = rows_.data() + node.row_list;
    for (int r = 0; r < node.rows; ++r) place_of[static_cast<std::size_t>(list[r])] = r;
    for (std::int64_t e = entry_begin_[s]; e < entry_begin_[s + 1]; ++e) {
      const auto at = static_cast<std::size_t>(e);
      const Entry& entry = entries_[at];
      entry_slot_[at] = entry.slot;
      entry_place_[at] = static_cast<std::int32_t>(place_of[static_cast<std::size_t>(entry.row)] +
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

/// Puts the front together, factorizes its pivots, and leaves what it hands on where `top` is, which moves behind it.
bool MultifrontalCholesky::factorize_supernode(int number, const SparseMatrix& matrix, double shift, Room& room,
                                               double*& top, std::vector<Waiting>& waiting) {
  cancellation_.throw_if_requested();
  const Supernode& node = supernodes_[static_cast<std::size_t>(number)];
  const double* values = matrix.valuePtr();
  double* front = room.front.data();
  // What is above the diagonal is never read.
  for_columns(node.rows, [&](int first, int end) {
    for (int c = first; c < end; ++c) std::fill_n(front + static_cast<std::int64_t>(c) * node.ld + c, node.ld - c, 0.0);
  });
  for (std::int64_t e = node.entries; e < supernodes_[static_cast<std::size_t>(number) + 1].entries; ++e)
    front[entry_place_[static_cast<std::size_t>(e)]] += values[entry_slot_[static_cast<std::size_t>(e)]];
  for (int k = 0; k < node.pivots; ++k) front[static_cast<std::int64_t>(k) * node.ld + k] += shift;
  while (!waiting.empty() && supernodes_[static_cast<std::size_t>(waiting.back().supernode)].parent == number) {
    const Supernode& child = supernodes_[static_cast<std::size_t>(waiting.back().supernode)];
    const int below = child.rows - child.pivots;
    if (waiting.back().on_stack) top -= static_cast<std::int64_t>(below) * below;
    extend_add(child, waiting.back().update, node, front);
    waiting.pop_back();
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
  waiting.push_back({number, top, true});
  for_columns(below, [&](int first, int end) {
    for (int c = first; c < end; ++c) {
      const double* column = front + static_cast<std::int64_t>(node.pivots + c) * node.ld + node.pivots;
      std::copy(column + c, column + below, top + static_cast<std::int64_t>(c) * below + c);
    }
  });
  top += static_cast<std::int64_t>(below) * below;
  return true;
}

bool MultifrontalCholesky::factorize_subtree(const SparseMatrix& matrix, double shift, Subtree& subtree, Room& room) {
  double* top = room.updates.data();
  std::vector<Waiting> waiting;
  for (int s = subtree.begin; s <= subtree.root; ++s)
    if (!factorize_supernode(s, matrix, shift, room, top, waiting)) return false;
  subtree.update.assign(room.updates.data(), top);
  return true;
}

/// The supernodes that are in no subtree, one after the other.
bool MultifrontalCholesky::factorize_upper(const SparseMatrix& matrix, double shift) {
  const int count = static_cast<int>(supernodes_.size()) - 1;
  double* top = room_.updates.data();
  std::vector<Waiting> waiting;
  auto subtree = subtrees_.begin();
  for (int s = 0; s < count; ++s) {
    if (subtree != subtrees_.end() && s == subtree->begin) {
      s = subtree->root;
      if (supernodes_[static_cast<std::size_t>(s)].parent >= 0) waiting.push_back({s, subtree->update.data(), false});
      ++subtree;
    } else if (!factorize_supernode(s, matrix, shift, room_, top, waiting)) {
      return false;
    }
  }
  return true;
}

bool MultifrontalCholesky::factorize(const SparseMatrix& matrix, double shift) {
  std::atomic<bool> definite = true;
  if (!subtrees_.empty()) {
    std::mutex rooms_mutex;
    parallel_for(static_cast<int>(subtrees_.size()), [&](int number) {
      if (!definite) return;
      Room room;
      {
        const std::lock_guard lock(rooms_mutex);
        if (!rooms_.empty()) {
          room = std::move(rooms_.back());
          rooms_.pop_back();
        }
      }
      make_room(room.front, of_subtrees_.front);
      make_room(room.updates, of_subtrees_.stacked);
      if (!factorize_subtree(matrix, shift, subtrees_[static_cast<std::size_t>(number)], room)) definite = false;
      const std::lock_guard lock(rooms_mutex);
      rooms_.push_back(std::move(room));
    });
  }
  return definite && factorize_upper(matrix, shift);
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
