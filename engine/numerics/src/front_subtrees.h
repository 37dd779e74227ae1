#pragma once

#include <cstddef>
#include <vector>

#include "front_tree.h"
#include "unset_numbers.h"

namespace supple::numerics {

/// A subtree of supernodes that one thread factorizes: the supernodes from `begin` to `root`.
struct Subtree {
  int begin = 0;
  int root = 0;
  UnsetNumbers update{};  ///< update matrix (Schur complement) of the root, which its parent adds
};

/// Subtrees of similar work for several threads, in the order of their supernodes; empty if there is too little work.
/// They do not depend on the number of threads.
std::vector<Subtree> independent_subtrees(const FrontTree& tree);

/// Numbers that the factorization of some supernodes needs.
struct WorkspaceSize {
  std::size_t front = 0;    ///< for the largest of their fronts
  std::size_t stacked = 0;  ///< for the update matrices that their parents have not yet added
};
/// The memory for the supernodes from `begin` up to `end`, which are whole subtrees, except those in `excluded`.
WorkspaceSize workspace_size(const FrontTree& tree, int begin, int end, const std::vector<Subtree>& excluded);

}  // namespace supple::numerics
