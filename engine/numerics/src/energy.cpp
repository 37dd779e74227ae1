#include "supple/numerics/energy.h"

namespace supple::numerics {

Eigen::SparseMatrix<double> HessianEntries::matrix(Eigen::Index n) const {
  Eigen::SparseMatrix<double> lower(n, n);
  lower.setFromTriplets(entries_.begin(), entries_.end());
  return lower.selfadjointView<Eigen::Lower>();
}

}  // namespace supple::numerics
