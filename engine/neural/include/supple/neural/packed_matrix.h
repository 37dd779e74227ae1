#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "supple/base/lanes.h"

namespace supple::neural {

/// Columns of activations are padded with zeros to a multiple of this number of rows, so that kernels need no loops for
/// remainders.
inline constexpr int row_multiple = 16;
SUPPLE_INLINE int padded_rows(int rows) { return (rows + row_multiple - 1) / row_multiple * row_multiple; }

/// A constant matrix in the order in which products read it. It consists of panels of consecutive rows; a panel has 64
/// bytes of each column, one column after another.
template <class Real>
class PackedMatrix {
 public:
  PackedMatrix() = default;
  explicit PackedMatrix(const Eigen::Ref<const Eigen::MatrixXd>& matrix) { assign(matrix); }
  void assign(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
  /// Packs `numbers`, in which columns (or rows, if `transposed`) begin `stride` numbers apart.
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

/// Instruction sets for products.
enum class Instructions { portable, avx2, avx512 };
/// The last of these instruction sets that this machine has.
Instructions best_instructions();

/// Computes c = a b for n columns: c[j stride_c + i] = sum_k a(i, k) b(k, j). It writes padded_rows(a.rows()) rows of
/// each column, and takes 2 n padded_rows(a.rows()) a.columns() flops. AVX2 and AVX-512 give the same bits. `use` is
/// for tests. An instruction set that the machine lacks ends the program.
template <class Real>
void multiply(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c,
              Instructions use = best_instructions());

}  // namespace supple::neural
