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

/// Cholesky factorization of a sparse symmetric matrix, P A P^T = L L^T, by the multifrontal method (Duff and Reid
/// 1983; Liu 1992).
///
/// CHOLMOD finds the ordering (see OrderingSearch) and the supernodes. The numerical part is ours: it maps every entry
/// of A to its place in a front once, and works on fronts of some dozen rows, as thin structures have them, at several
/// times CHOLMOD's rate. Threads take subtrees of supernodes, and share the large fronts above them; the results have
/// the same bits for any number of threads.
class MultifrontalCholesky {
 public:
  /// From now on `analyze` and `factorize` throw what the token throws.
  void stop_with(const CancellationToken& cancellation) { cancellation_ = cancellation; }

  /// How orderings are looked for from now on.
  void search_orderings(OrderingSearch search) { search_ = search; }

  /// Orders and analyses the pattern of the lower triangle of `matrix` (entries above the diagonal are ignored). A
  /// pattern of the size of the last one keeps its supernodes, then its ordering, as long as these serve it well.
  void analyze(const SparseMatrix& matrix);
  /// Factorizes matrix + shift I, whose pattern is the analysed one. False where it is not numerically positive
  /// definite.
  bool factorize(const SparseMatrix& matrix, double shift);
  /// Overwrites the columns of b by A^-1 b, four at a time.
  void solve(Eigen::Ref<Eigen::MatrixXd> b) const;

 private:
  struct Supernode {
    int first = 0;   ///< first of its columns, in the new order
    int pivots = 0;  ///< number of its columns
    int rows = 0;    ///< rows of its front: the pivots and those below
    int ld = 0;      ///< leading dimension of its panel
    int parent = -1;
    std::int64_t row_list = 0;  ///< into rows_
    std::int64_t panel = 0;     ///< into factor_
    std::int64_t entries = 0;   ///< into entry_slot_ and entry_place_, up to that of the next
    std::int64_t relative = 0;  ///< into relative_
  };

  /// An entry of the matrix, in the new order: that of the earlier of its two unknowns and of the later.
  struct Entry {
    int pivot;
    int row;
    std::int64_t slot;
  };
  /// The columns and rows of fronts, as of SymbolicAnalysis.
  struct Fronts {
    std::vector<int> first;
    std::vector<int> row_begin;
    std::vector<int> rows;
  };

  /// A subtree of the supernodes that one thread factorizes, which are those from `begin` to `root`.
  struct Subtree {
    int begin = 0;
    int root = 0;
    UnsetNumbers update;  ///< what the root hands on to its parent
  };
  /// Room for the factorization of some supernodes.
  struct Room {
    UnsetNumbers front;    ///< for the largest of their fronts
    UnsetNumbers updates;  ///< stack of the update matrices that wait for their parents
  };
  struct RoomSize {
    std::size_t front = 0;
    std::size_t stacked = 0;
  };
  /// A supernode whose update matrix waits for its parent.
  struct Waiting {
    int supernode;
    const double* update;
    bool on_stack;
  };

  void solve_one(double* b) const;
  int longest_below() const;
  void set_order(std::vector<int> old_index);
  void set_fronts(const Fronts& fronts);
  void group_entries(const SparseMatrix& matrix, const std::vector<int>& first);
  std::optional<Fronts> fronts_of_same_supernodes() const;
  bool sort_into_postorder(Fronts& fronts);
  void place_entries();
  void find_relative_rows();
  static double work_of(const Supernode& node);
  void choose_subtrees();
  RoomSize room_for(int begin, int end, const std::vector<Subtree>& without) const;
  void size_rooms();
  bool factorize_subtree(const SparseMatrix& matrix, double shift, Subtree& subtree, Room& room);
  bool factorize_upper(const SparseMatrix& matrix, double shift);
  bool factorize_supernode(int number, const SparseMatrix& matrix, double shift, Room& room, double*& top,
                           std::vector<Waiting>& waiting);
  void extend_add(const Supernode& child, const double* update, const Supernode& parent, double* front) const;

  CancellationToken cancellation_;
  OrderingSearch search_ = OrderingSearch::thorough;
  int n_ = 0;
  double best_entries_ = 0;         ///< of the factor, with the ordering's own pattern
  std::int64_t front_entries_ = 0;  ///< of the fronts' columns, with the pattern of which CHOLMOD made the supernodes
  std::vector<int> new_index_;      ///< of each unknown
  std::vector<int> old_index_;
  std::vector<int> supernode_of_;          ///< of each column, in the new order
  std::vector<Entry> entries_;             ///< of the pattern, by supernodes; until they have their places
  std::vector<std::int64_t> entry_begin_;  ///< of each supernode in entries_, and their end
  std::vector<Supernode> supernodes_;      ///< children before parents; the last entry is an end mark
  std::vector<int> rows_;                  ///< row lists of the fronts, in the new order
  std::vector<int> relative_;              ///< for each row below the pivots its place in the parent's front
  std::vector<std::int64_t> entry_slot_;   ///< index into the matrix' values
  std::vector<std::int32_t> entry_place_;  ///< where it goes in its front
  UnsetNumbers factor_;
  std::vector<Subtree> subtrees_;  ///< in the order of their supernodes; none where the whole is little work
  Room room_;                      ///< for all other supernodes
  std::vector<Room> rooms_;        ///< for subtrees, which threads take and give back
  RoomSize of_subtrees_;           ///< the largest of theirs
};

}  // namespace supple::numerics
