#pragma once

#include <Eigen/Core>
#include <memory>

#include "supple/base/cancellation.h"
#include "supple/base/cost_ledger.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// Below this many unknowns a sparse matrix is factorized as a dense one: the sparse bookkeeping costs more than the
/// n^3 / 3 operations it saves.
inline constexpr Eigen::Index dense_cholesky_limit = 64;

/// The Cholesky factorization of H + shift I. Dense matrices and small ones are factorized by Eigen's LLT, O(n^3).
/// Sparse matrices are factorized by a multifrontal method with CHOLMOD's ordering and supernodes (Chen, Davis, Hager
/// and Rajamanickam 2008), whose symbolic analysis is kept as long as the pattern stays the same. For a bordered matrix
/// the core is factorized in this way, and the Schur complement of the corner as a dense matrix. The part of low rank
/// is included by the formula of Sherman, Morrison and Woodbury (1950), and the rest has to be positive definite
/// without it.
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

  /// How often a sparse pattern was analysed.
  int analyses() const;

  /// From now on factorizations throw what the token throws, some milliseconds after a stop is requested. The ordering
  /// of a large pattern cannot be interrupted, and therefore runs in a helper process if there are any.
  void stop_with(const CancellationToken& cancellation);

  /// From now on sparse patterns are ordered in less time, perhaps with a factor of more entries: for matrices that are
  /// factorized only a few times.
  void order_quickly();

  /// From now on bills the stages "factorization" and "solve" to the ledger, which must outlive this. Null means none.
  void bill_to(CostLedger* cost);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The root of the mean square of the rows' norms, which is the scale of a shift; 1 for zero. It is the same for each
/// orthonormal frame in which parts of the unknowns are written, so that the regularization does not depend on the
/// frames. Of a bordered matrix it is that of the core. O(entries).
double matrix_scale(const Hessian& hessian);

}  // namespace supple::numerics
