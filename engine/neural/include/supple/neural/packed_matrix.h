#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "supple/base/lanes.h"

namespace supple::neural {

/// Numbers between the beginnings of two columns of activations: rows are padded with zeros to a multiple of this, so
/// that kernels know no remainders.
inline constexpr int row_multiple = 16;
SUPPLE_INLINE int padded_rows(int rows) { return (rows + row_multiple - 1) / row_multiple * row_multiple; }

/// A constant matrix in the order in which the product reads it: panels of 64 bytes of rows, each column after column.
template <class Real>
class PackedMatrix {
 public:
  PackedMatrix() = default;
  explicit PackedMatrix(const Eigen::Ref<const Eigen::MatrixXd>& matrix) { assign(matrix); }
  void assign(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
  /// From columns of `stride` numbers, or (transposed) from rows of as many.
  void assign(const Real* numbers, int rows, int columns, int stride, bool transposed);

  int rows() const { return rows_; }
  SUPPLE_INLINE int columns() const { return columns_; }
  SUPPLE_INLINE const Real* panel(int index) const {
    return numbers_.data() + static_cast<std::ptrdiff_t>(index) * panel_rows * columns_;
  }
  SUPPLE_INLINE int panels() const { return padded_rows(rows_) / panel_rows; }

  static constexpr int panel_rows = 64 / sizeof(Real);

 private:
  int rows_ = 0;
  int columns_ = 0;
  std::vector<Real> numbers_;
};

/// The right factor of a product: entry (k, j) is numbers[k step + j stride].
template <class Real>
struct Factor {
  const Real* numbers = nullptr;
  std::ptrdiff_t stride = 0;
  std::ptrdiff_t step = 1;

  SUPPLE_INLINE Factor from_column(std::ptrdiff_t j) const { return {numbers + j * stride, stride, step}; }
};

enum class Instructions { any, avx2, avx512 };
/// The last of them that this machine has.
Instructions best_instructions();

/// c = a b for n columns: c[j stride_c + i] = sum_k a(i, k) b(k, j). Writes padded_rows(a.rows()) rows of
/// each column. 2 n padded_rows(a.rows()) a.columns() flops. AVX2 and AVX-512 give the same bits. `use` is for tests:
/// beyond what the machine has, the program is killed.
template <class Real>
void multiply(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c,
              Instructions use = best_instructions());

}  // namespace supple::neural
