#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/numerics/objective.h"
#include "symbolic_analysis.h"

namespace supple::numerics {

/// The elimination tree of a sparse symmetric matrix: its fill-reducing order, the supernodes, and the rows of their
/// fronts. CHOLMOD computes the ordering (see OrderingSearch) and the supernodes. The position of every entry of the
/// matrix in a front is computed once.
class FrontTree {
 public:
  struct Supernode {
    int first = 0;   ///< first of its columns, in the new order
    int pivots = 0;  ///< number of its columns
    int rows = 0;    ///< number of rows of its front, pivots included
    int ld = 0;      ///< leading dimension of its panel
    int parent = -1;
    std::int64_t row_list = 0;  ///< index into the rows of its first row
    std::int64_t panel = 0;     ///< index into the factor of its panel
    /// Index of its first entry in the entries' slots and positions; they end at that of the next.
    std::int64_t entries = 0;
    std::int64_t relative = 0;  ///< index into the relative rows of its first row below the pivots
  };

  /// Sets the token: later calls of `analyze` throw what it throws.
  void stop_with(const CancellationToken& cancellation) { cancellation_ = cancellation; }
  /// Sets how later analyses search for an ordering.
  void search_orderings(OrderingSearch search) { search_ = search; }
  /// Orders and analyses the pattern of the lower triangle of `matrix` (entries above the diagonal are ignored). If the
  /// size is that of the last pattern, the supernodes are reused, or else the ordering, while the factor stays small
  /// enough.
  void analyze(const SparseMatrix& matrix);

  int unknowns() const { return n_; }
  int count() const { return static_cast<int>(supernodes_.size()) - 1; }
  /// A supernode; children come before parents. The one after the last only marks the end.
  const Supernode& node(int number) const { return supernodes_[static_cast<std::size_t>(number)]; }
  /// The number of entries of all panels.
  std::int64_t panel_entries() const { return panel_entries_; }
  /// The rows of a supernode's front, in the new order.
  const int* rows_of(const Supernode& node) const { return rows_.data() + node.row_list; }
  /// For each row of a supernode's front below the pivots, its position in the parent's front.
  const int* relative_rows_of(const Supernode& node) const { return relative_.data() + node.relative; }
  /// The index of an entry in the matrix' values, and in the values of its front.
  std::int64_t entry_slot(std::int64_t entry) const { return entry_slot_[static_cast<std::size_t>(entry)]; }
  std::int32_t entry_position(std::int64_t entry) const { return entry_position_[static_cast<std::size_t>(entry)]; }
  /// The unknown at each place of the new order.
  const std::vector<int>& old_index() const { return old_index_; }
  /// The largest number of rows below the pivots of a front.
  int max_update_rows() const;

 private:
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

  void set_order(std::vector<int> old_index);
  void set_fronts(const Fronts& fronts);
  void group_entries(const SparseMatrix& matrix, const std::vector<int>& first);
  std::optional<Fronts> fronts_of_same_supernodes() const;
  bool sort_into_postorder(Fronts& fronts);
  void find_relative_rows();
  void locate_entries();

  CancellationToken cancellation_;
  OrderingSearch search_ = OrderingSearch::thorough;
  int n_ = 0;
  double best_entries_ = 0;  ///< number of factor entries that the ordering had with the pattern for which it was made
  std::int64_t panel_entries_ = 0;
  std::int64_t first_panel_entries_ = 0;  ///< panel_entries_ with the pattern for which CHOLMOD made the supernodes
  std::vector<int> new_index_;            ///< position of each unknown in the new order
  std::vector<int> old_index_;
  std::vector<int> supernode_of_;          ///< supernode of each column, in the new order
  std::vector<Entry> entries_;             ///< entries of the pattern, grouped by supernodes; emptied by locate_entries
  std::vector<std::int64_t> entry_begin_;  ///< index into entries_ of each supernode's first, and their number
  std::vector<Supernode> supernodes_;
  std::vector<int> rows_;
  std::vector<int> relative_;
  std::vector<std::int64_t> entry_slot_;
  std::vector<std::int32_t> entry_position_;
};

}  // namespace supple::numerics
