#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/numerics/objective.h"
#include "symbolic_analysis.h"
#include "unset_numbers.h"

namespace supple::numerics {

/// Cholesky factorization of a sparse symmetric matrix, P A P^T = L L^T, by the multifrontal method [Duff1983]
/// [Liu1992].
///
/// CHOLMOD computes the ordering (see OrderingSearch) and the supernodes. The numerical factorization is our own. It
/// computes the position of every entry of A in a front once. Fronts of some dozen rows, as thin structures have them,
/// are factorized at several times CHOLMOD's rate. Threads take subtrees of supernodes, and share the large fronts
/// above them. The results have the same bits for any number of threads.
class MultifrontalCholesky {
 public:
  /// Sets the token: later calls of `analyze` and `factorize` throw what it throws.
  void stop_with(const CancellationToken& cancellation) { cancellation_ = cancellation; }

  /// Sets how later analyses search for an ordering.
  void search_orderings(OrderingSearch search) { search_ = search; }

  /// Orders and analyses the pattern of the lower triangle of `matrix` (entries above the diagonal are ignored). If the
  /// size is that of the last pattern, the supernodes are reused, or else the ordering, while the factor stays small
  /// enough.
  void analyze(const SparseMatrix& matrix);
  /// Factorizes matrix + shift I, whose pattern is the analysed one. Returns false if it is not numerically positive
  /// definite.
  bool factorize(const SparseMatrix& matrix, double shift);
  /// Overwrites the columns of b by A^-1 b, four at a time.
  void solve(Eigen::Ref<Eigen::MatrixXd> b) const;

 private:
  struct Supernode {
    int first = 0;   ///< first of its columns, in the new order
    int pivots = 0;  ///< number of its columns
    int rows = 0;    ///< number of rows of its front, pivots included
    int ld = 0;      ///< leading dimension of its panel
    int parent = -1;
    std::int64_t row_list = 0;  ///< index into rows_ of its first row
    std::int64_t panel = 0;     ///< index into factor_ of its panel
    /// Index of its first entry in entry_slot_ and entry_position_; they end at that of the next.
    std::int64_t entries = 0;
    std::int64_t relative = 0;  ///< index into relative_ of its first row below the pivots
  };

  /// An entry of the matrix: the earlier and the later of its two unknowns in the new order, and its index in the
  /// values.
  struct Entry {
    int pivot;
    int row;
    std::int64_t slot;
  };
  /// The columns and rows of fronts, as in SymbolicAnalysis.
  struct Fronts {
    std::vector<int> first;
    std::vector<int> row_begin;
    std::vector<int> rows;
  };

  /// A subtree of supernodes that one thread factorizes: the supernodes from `begin` to `root`.
  struct Subtree {
    int begin = 0;
    int root = 0;
    UnsetNumbers update;  ///< update matrix (Schur complement) of the root, which its parent adds
  };
  /// Memory for the factorization of some supernodes.
  struct Workspace {
    UnsetNumbers front;    ///< for the largest of their fronts
    UnsetNumbers updates;  ///< stack of the update matrices that their parents have not yet added
  };
  struct WorkspaceSize {
    std::size_t front = 0;
    std::size_t stacked = 0;
  };
  /// An update matrix that the supernode's parent has not yet added.
  struct PendingUpdate {
    int supernode;
    const double* update;
    bool on_stack;
  };

  void solve_one(double* b) const;
  int max_update_rows() const;
  void set_order(std::vector<int> old_index);
  void set_fronts(const Fronts& fronts);
  void group_entries(const SparseMatrix& matrix, const std::vector<int>& first);
  std::optional<Fronts> fronts_of_same_supernodes() const;
  bool sort_into_postorder(Fronts& fronts);
  void locate_entries();
  void find_relative_rows();
  static double operations(const Supernode& node);
  void choose_subtrees();
  WorkspaceSize workspace_size(int begin, int end, const std::vector<Subtree>& excluded) const;
  void allocate_workspaces();
  bool factorize_subtree(const SparseMatrix& matrix, double shift, Subtree& subtree, Workspace& workspace);
  bool factorize_upper(const SparseMatrix& matrix, double shift);
  bool factorize_supernode(int number, const SparseMatrix& matrix, double shift, Workspace& workspace, double*& top,
                           std::vector<PendingUpdate>& pending);
  void extend_add(const Supernode& child, const double* update, const Supernode& parent, double* front) const;

  CancellationToken cancellation_;
  OrderingSearch search_ = OrderingSearch::thorough;
  int n_ = 0;
  double best_entries_ = 0;  ///< number of factor entries that the ordering had with the pattern for which it was made
  std::int64_t front_entries_ = 0;  ///< size of the panels with the pattern for which CHOLMOD made the supernodes
  std::vector<int> new_index_;      ///< position of each unknown in the new order
  std::vector<int> old_index_;
  std::vector<int> supernode_of_;          ///< supernode of each column, in the new order
  std::vector<Entry> entries_;             ///< entries of the pattern, grouped by supernodes; emptied by locate_entries
  std::vector<std::int64_t> entry_begin_;  ///< index into entries_ of each supernode's first, and their number
  std::vector<Supernode> supernodes_;      ///< children come before parents; the last element only marks the end
  std::vector<int> rows_;                  ///< rows of the fronts, in the new order
  std::vector<int> relative_;              ///< for each row below the pivots, its position in the parent's front
  std::vector<std::int64_t> entry_slot_;   ///< index into the matrix' values
  std::vector<std::int32_t> entry_position_;  ///< index into the front's values
  UnsetNumbers factor_;
  /// Subtrees in the order of their supernodes; empty if there is too little work for several threads.
  std::vector<Subtree> subtrees_;
  Workspace workspace_;                     ///< memory for supernodes outside of subtrees
  std::vector<Workspace> idle_workspaces_;  ///< memory for subtrees; a thread takes one and returns it
  WorkspaceSize subtree_workspace_;         ///< maximum size over the subtrees
};

}  // namespace supple::numerics
