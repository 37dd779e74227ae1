#include "multifrontal_cholesky.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <utility>
#include <vector>

#include "partial_cholesky.h"
#include "supple/base/threads.h"

namespace supple::numerics {
namespace {

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

}  // namespace

void MultifrontalCholesky::analyze(const SparseMatrix& matrix) {
  tree_.analyze(matrix);
  discard_and_resize(factor_, static_cast<std::size_t>(tree_.panel_entries()));
  subtrees_ = independent_subtrees(tree_);
  const WorkspaceSize upper = workspace_size(tree_, 0, tree_.count(), subtrees_);
  discard_and_resize(workspace_.front, upper.front);
  discard_and_resize(workspace_.updates, upper.stacked);
  subtree_workspace_ = {};
  for (const Subtree& subtree : subtrees_) {
    const WorkspaceSize size = workspace_size(tree_, subtree.begin, subtree.root + 1, {});
    subtree_workspace_ = {std::max(subtree_workspace_.front, size.front),
                          std::max(subtree_workspace_.stacked, size.stacked)};
  }
}

void MultifrontalCholesky::extend_add(const Supernode& child, const double* update, const Supernode& parent,
                                      double* front) const {
  const int below = child.rows - child.pivots;
  const int* relative = tree_.relative_rows_of(child);
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
  const Supernode& node = tree_.node(number);
  const double* values = matrix.valuePtr();
  double* front = workspace.front.data();
  // Only lower triangles are read.
  for_columns(node.rows, [&](int first, int end) {
    for (int c = first; c < end; ++c) std::fill_n(front + static_cast<std::int64_t>(c) * node.ld + c, node.ld - c, 0.0);
  });
  for (std::int64_t e = node.entries; e < tree_.node(number + 1).entries; ++e)
    front[tree_.entry_position(e)] += values[tree_.entry_slot(e)];
  for (int k = 0; k < node.pivots; ++k) front[static_cast<std::int64_t>(k) * node.ld + k] += shift;
  while (!pending.empty() && tree_.node(pending.back().supernode).parent == number) {
    const Supernode& child = tree_.node(pending.back().supernode);
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
  const int count = tree_.count();
  double* top = workspace_.updates.data();
  std::vector<PendingUpdate> pending;
  auto subtree = subtrees_.begin();
  for (int s = 0; s < count; ++s) {
    if (subtree != subtrees_.end() && s == subtree->begin) {
      s = subtree->root;
      if (tree_.node(s).parent >= 0) pending.push_back({s, subtree->update.data(), false});
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
  const int count = tree_.count();
  const int n = tree_.unknowns();
  const std::vector<int>& old_index = tree_.old_index();
  Eigen::VectorXd x(n);
  Eigen::VectorXd below(tree_.max_update_rows());
  for (int i = 0; i < n; ++i) x[i] = b[old_index[static_cast<std::size_t>(i)]];
  for (int s = 0; s < count; ++s) {
    const Supernode& node = tree_.node(s);
    panel_forward_one(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.data() + node.first,
                      below.data());
    const int* list = tree_.rows_of(node) + node.pivots;
    for (int r = 0; r < node.rows - node.pivots; ++r) x[list[r]] -= below[r];
  }
  for (int s = count; s-- > 0;) {
    const Supernode& node = tree_.node(s);
    const int* list = tree_.rows_of(node) + node.pivots;
    for (int r = 0; r < node.rows - node.pivots; ++r) below[r] = x[list[r]];
    panel_backward_one(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.data() + node.first,
                       below.data());
  }
  for (int i = 0; i < n; ++i) b[old_index[static_cast<std::size_t>(i)]] = x[i];
}

void MultifrontalCholesky::solve(Eigen::Ref<Eigen::MatrixXd> b) const {
  if (b.cols() == 1) return solve_one(b.data());
  const int count = tree_.count();
  const int n = tree_.unknowns();
  const std::vector<int>& old_index = tree_.old_index();
  // Columns of solve_width numbers, one for each unknown in the new order.
  Eigen::Matrix<double, solve_width, Eigen::Dynamic> x(solve_width, n);
  Eigen::Matrix<double, solve_width, Eigen::Dynamic> below(solve_width, tree_.max_update_rows());
  for (Eigen::Index begin = 0; begin < b.cols(); begin += solve_width) {
    const auto width = std::min<Eigen::Index>(solve_width, b.cols() - begin);
    x.setZero();
    for (Eigen::Index c = 0; c < width; ++c)
      for (int i = 0; i < n; ++i) x(c, i) = b(old_index[static_cast<std::size_t>(i)], begin + c);
    for (int s = 0; s < count; ++s) {
      const Supernode& node = tree_.node(s);
      panel_forward(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.col(node.first).data(),
                    below.data());
      const int* list = tree_.rows_of(node) + node.pivots;
      for (int r = 0; r < node.rows - node.pivots; ++r) x.col(list[r]) -= below.col(r);
    }
    for (int s = count; s-- > 0;) {
      const Supernode& node = tree_.node(s);
      const int* list = tree_.rows_of(node) + node.pivots;
      for (int r = 0; r < node.rows - node.pivots; ++r) below.col(r) = x.col(list[r]);
      panel_backward(factor_.data() + node.panel, node.ld, node.rows, node.pivots, x.col(node.first).data(),
                     below.data());
    }
    for (Eigen::Index c = 0; c < width; ++c)
      for (int i = 0; i < n; ++i) b(old_index[static_cast<std::size_t>(i)], begin + c) = x(c, i);
  }
}

}  // namespace supple::numerics
