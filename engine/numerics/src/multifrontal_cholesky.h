#pragma once

#include <vector>

#include "front_subtrees.h"
#include "front_tree.h"
#include "supple/base/cancellation.h"
#include "supple/numerics/objective.h"
#include "unset_numbers.h"

namespace supple::numerics {

/// Cholesky factorization of a sparse symmetric matrix, P A P^T = L L^T, by the multifrontal method [Duff1983]
/// [Liu1992].
///
/// The ordering and the supernodes are those of FrontTree. The numerical factorization is our own. Fronts of some dozen
/// rows, as thin structures have them, are factorized at several times CHOLMOD's rate. Threads take subtrees of
/// supernodes, and share the large fronts above them. The results have the same bits for any number of threads.
class MultifrontalCholesky {
 public:
  /// Sets the token: later calls of `analyze` and `factorize` throw what it throws.
  void stop_with(const CancellationToken& cancellation) {
    cancellation_ = cancellation;
    tree_.stop_with(cancellation);
  }

  /// Sets how later analyses search for an ordering.
  void search_orderings(OrderingSearch search) { tree_.search_orderings(search); }

  /// See FrontTree::analyze.
  void analyze(const SparseMatrix& matrix);
  /// Factorizes matrix + shift I, whose pattern is the analysed one. Returns false if it is not numerically positive
  /// definite.
  bool factorize(const SparseMatrix& matrix, double shift);
  /// Overwrites the columns of b by A^-1 b, four at a time.
  void solve(Eigen::Ref<Eigen::MatrixXd> b) const;

 private:
  using Supernode = FrontTree::Supernode;

  /// Memory for the factorization of some supernodes.
  struct Workspace {
    UnsetNumbers front;    ///< for the largest of their fronts
    UnsetNumbers updates;  ///< stack of the update matrices that their parents have not yet added
  };
  /// An update matrix that the supernode's parent has not yet added.
  struct PendingUpdate {
    int supernode;
    const double* update;
    bool on_stack;
  };

  void solve_one(double* b) const;
  bool factorize_subtree(const SparseMatrix& matrix, double shift, Subtree& subtree, Workspace& workspace);
  bool factorize_upper(const SparseMatrix& matrix, double shift);
  bool factorize_supernode(int number, const SparseMatrix& matrix, double shift, Workspace& workspace, double*& top,
                           std::vector<PendingUpdate>& pending);
  void extend_add(const Supernode& child, const double* update, const Supernode& parent, double* front) const;

  CancellationToken cancellation_;
  FrontTree tree_;
  UnsetNumbers factor_;  ///< the panels of all supernodes
  std::vector<Subtree> subtrees_;
  Workspace workspace_;                     ///< memory for supernodes outside of subtrees
  std::vector<Workspace> idle_workspaces_;  ///< memory for subtrees; a thread takes one and returns it
  WorkspaceSize subtree_workspace_;         ///< maximum size over the subtrees
};

}  // namespace supple::numerics
