#pragma once

#include <vector>

#include "supple/base/cancellation.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// The symbolic analysis of a pattern by CHOLMOD: the new order, and the supernodes of the factor.
struct SymbolicAnalysis {
  std::vector<int> old_index;  ///< old index of each unknown, in the new order
  std::vector<int> first;      ///< first column of each supernode; the last element is the number of unknowns
  std::vector<int> row_begin;  ///< index into `rows` of each supernode's first row; the last element is their number
  std::vector<int> rows;
  double entries = 0;  ///< number of entries of the factor
};

/// How CHOLMOD searches for an ordering.
enum class OrderingSearch {
  thorough,  ///< the better one of approximate minimum degree and METIS' nested dissection
  /// Approximate minimum degree, and METIS only if CHOLMOD expects much fill-in. METIS takes the time of some
  /// factorizations, which does not pay for matrices that are factorized only a few times.
  quick,
};

/// Analyses the lower triangle of a compressed matrix. `ordering` may come from a similar pattern of the same size. If
/// it is empty, an ordering is searched for.
///
/// CHOLMOD does not check for stop requests. Large patterns are therefore analysed in a helper process, if this process
/// has any (`helper_processes`), with the same result. Throws std::bad_alloc, and what the token throws.
SymbolicAnalysis analyse(const SparseMatrix& matrix, const std::vector<int>& ordering,
                         const CancellationToken& cancellation, OrderingSearch search = OrderingSearch::thorough);

/// The same in this process. `columns` and `rows` are the index arrays of a compressed matrix with n columns.
SymbolicAnalysis analyse_here(int n, const int* columns, const int* rows, const std::vector<int>& ordering,
                              OrderingSearch search = OrderingSearch::thorough);

}  // namespace supple::numerics
