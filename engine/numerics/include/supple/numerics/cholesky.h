#pragma once

#include <Eigen/Core>
#include <memory>

#include "supple/base/cancellation.h"
#include "supple/base/cost_ledger.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// Below this number of unknowns a sparse matrix is factorized as a dense one: the sparse bookkeeping would cost more
/// than the n^3 / 3 operations that it saves.
inline constexpr Eigen::Index dense_cholesky_limit = 64;

/// The Cholesky factorization of H + shift I.
///
/// Dense matrices and small ones are factorized by Eigen's LLT, O(n^3). Sparse matrices are factorized by a
/// multifrontal method with CHOLMOD's ordering and supernodes [Chen2008]. Its symbolic analysis is reused as long as
/// the pattern stays the same. For a bordered matrix the core is factorized in this way, and the Schur complement of
/// the corner as a dense matrix. The low-rank part is included by the Sherman-Morrison-Woodbury formula [Sherman1950];
/// the matrix without it has to be positive definite.
class ShiftedCholesky {
 public:
  ShiftedCholesky();
  ~ShiftedCholesky();
  ShiftedCholesky(const ShiftedCholesky&) = delete;
  ShiftedCholesky& operator=(const ShiftedCholesky&) = delete;

  /// Factorizes. Returns false if H + shift I is not numerically positive definite. `hessian` must not be empty.
  bool factorize(const Hessian& hessian, double shift);

  /// Solves (H + shift I) x = b for the last matrix that was factorized successfully.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

  /// Solves with the core of a bordered matrix alone, for every column of `b`.
  Eigen::MatrixXd solve_core(const Eigen::MatrixXd& b) const;

  /// The number of symbolic analyses so far.
  int analyses() const;

  /// Sets the token: later factorizations throw what it throws, some milliseconds after a stop is requested. The
  /// ordering of a large pattern cannot be interrupted, and therefore runs in a helper process if there are any.
  void stop_with(const CancellationToken& cancellation);

  /// Makes later orderings faster, perhaps with more entries in the factor. It pays for matrices that are factorized
  /// only a few times.
  void use_fast_ordering();

  /// Sets the ledger to which the stages "factorization" and "solve" are billed; it must outlive this object. Null
  /// means none.
  void bill_to(CostLedger* cost);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The scale of a regularizing shift: the root of the mean square of the rows' norms, and 1 for a zero matrix. For a
/// bordered matrix only the core counts. Turning the orthonormal frames in which parts of the unknowns are written does
/// not change it, so the regularization does not depend on the frames. O(entries).
double matrix_scale(const Hessian& hessian);

}  // namespace supple::numerics
