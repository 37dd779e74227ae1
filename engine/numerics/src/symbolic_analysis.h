#pragma once

#include <vector>

#include "supple/base/cancellation.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// What CHOLMOD says of a pattern: the new order and the supernodes of the factor.
struct SymbolicAnalysis {
  std::vector<int> old_index;  ///< of each unknown in the new order
  std::vector<int> first;      ///< columns of each supernode begin here; the last entry is the number of unknowns
  std::vector<int> row_begin;  ///< of each supernode in `rows`; the last entry is their number
  std::vector<int> rows;
  double entries = 0;  ///< of the factor
};

/// How an ordering is looked for.
enum class OrderingSearch {
  thorough,  ///< the better of approximate minimum degree and METIS' nested dissection
  /// Approximate minimum degree, and METIS only where CHOLMOD finds that the factor fills much. METIS takes the time of
  /// some factorizations, which matrices that are factorized only a few times do not win back.
  quick,
};

/// Of the lower triangle of a compressed matrix, with the ordering that is `known` from a similar pattern of the same
/// size or, if that is empty, with one that is looked for.
///
/// CHOLMOD looks for no stop request. Patterns that take it longer than a moment are analysed in a helper process where
/// this one has any (`helper_processes`), with the same result. Throws std::bad_alloc, and what the token throws.
SymbolicAnalysis analyse(const SparseMatrix& matrix, const std::vector<int>& known,
                         const CancellationToken& cancellation, OrderingSearch search = OrderingSearch::thorough);

/// The same in this process. Columns and rows as of a compressed matrix of n columns.
SymbolicAnalysis analyse_here(int n, const int* columns, const int* rows, const std::vector<int>& known,
                              OrderingSearch search = OrderingSearch::thorough);

}  // namespace supple::numerics
