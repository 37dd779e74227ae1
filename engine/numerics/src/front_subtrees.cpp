#include "front_subtrees.h"

#include <algorithm>
#include <utility>

namespace supple::numerics {
namespace {

/// Multiply-adds from which on several threads are used: some milliseconds.
constexpr double min_parallel_work = 1e7;
/// Limits of a subtree's work, as fractions of the total. A subtree above the first is divided. One below the second is
/// factorized together with the supernodes above it.
constexpr double max_subtree_fraction = 0.1;
constexpr double min_subtree_fraction = 0.002;

/// Approximate number of multiply-adds of a supernode's factorization.
double operations(const FrontTree::Supernode& node) {
  return 0.5 * static_cast<double>(node.pivots) * node.rows * node.rows;
}

}  // namespace

/// Divides the largest subtrees into their children until none has more than max_subtree_fraction of the work.
std::vector<Subtree> independent_subtrees(const FrontTree& tree) {
  const int count = tree.count();
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
    const FrontTree::Supernode& node = tree.node(s);
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
  if (total < min_parallel_work) return {};
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
  std::vector<Subtree> subtrees;
  for (const auto& [subtree_work, root] : heap)
    if (subtree_work > total * min_subtree_fraction)
      subtrees.push_back({begin[static_cast<std::size_t>(root)], root, {}});
  return subtrees;
}

WorkspaceSize workspace_size(const FrontTree& tree, int begin, int end, const std::vector<Subtree>& excluded) {
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
    const FrontTree::Supernode& node = tree.node(s);
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

}  // namespace supple::numerics
