// Only inlined functions pass packs by value here, so that their calling convention does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"
#include "supple/neural/packed_matrix.h"

#include <cstring>

#include "supple/neural/packs.h"

namespace supple::neural {
namespace {

/// Computes the tile of `Panels` panels by `Columns` columns of the product. Its sums, at most 12 vectors, are held in
/// the 16 registers.
template <class Real, int Panels, int Columns>
SUPPLE_INLINE void multiply_tile(const PackedMatrix<Real>& a, int panel, const Factor<Real>& b, Real* c, int stride_c) {
  constexpr int packs = 2 * Panels;
  constexpr int count = Packs<Real>::count;
  constexpr int panel_rows = PackedMatrix<Real>::panel_rows;
  Pack<Real> sum[packs][Columns];
  const Real* from[Panels];
  for (int p = 0; p < Panels; ++p) from[p] = a.panel(panel + p);
  Real* to = c + panel * panel_rows;
#pragma GCC unroll 16
  for (int p = 0; p < packs; ++p)
#pragma GCC unroll 16
    for (int j = 0; j < Columns; ++j) sum[p][j] = all_of<Real>(0);
  const int depth = a.columns();
  for (int k = 0; k < depth; ++k) {
    Pack<Real> row[packs];
#pragma GCC unroll 16
    for (int p = 0; p < packs; ++p) row[p] = load_pack<Real>(from[p / 2] + k * panel_rows + (p % 2) * count);
#pragma GCC unroll 16
    for (int j = 0; j < Columns; ++j) {
      // A number times a pack compiles to one broadcasting load. A pack that is made from the number does not.
      const Real factor = b.numbers[k * b.step + j * b.stride];
#pragma GCC unroll 16
      for (int p = 0; p < packs; ++p) sum[p][j] += row[p] * factor;
    }
  }
#pragma GCC unroll 16
  for (int p = 0; p < packs; ++p)
#pragma GCC unroll 16
    for (int j = 0; j < Columns; ++j) store_pack<Real>(to + j * stride_c + p * count, sum[p][j]);
}

/// Computes all rows of `Columns` columns. If there are few columns, several panels are multiplied at once, so that
/// there are enough independent sums.
template <class Real, int Columns>
SUPPLE_INLINE void multiply_columns(const PackedMatrix<Real>& a, const Factor<Real>& b, Real* c, int stride_c) {
  constexpr int panels_at_once = Columns >= 4 ? 1 : Columns >= 2 ? 2 : 4;
  int panel = 0;
  for (; panel + panels_at_once <= a.panels(); panel += panels_at_once)
    multiply_tile<Real, panels_at_once, Columns>(a, panel, b, c, stride_c);
  for (; panel < a.panels(); ++panel) multiply_tile<Real, 1, Columns>(a, panel, b, c, stride_c);
}

template <class Real>
SUPPLE_INLINE void multiply_all(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c) {
  // A panel remains in the first-level cache while it is multiplied with all columns.
  const int sixes = n / 6 * 6;
  if (n > 6)
    for (int panel = 0; panel < a.panels(); ++panel)
      for (int j = 0; j < sixes; j += 6)
        multiply_tile<Real, 1, 6>(a, panel, b.from_column(j), c + j * stride_c, stride_c);
  else if (n == 6)
    multiply_columns<Real, 6>(a, b, c, stride_c);
  const Factor<Real> rest = b.from_column(sixes);
  c += static_cast<std::ptrdiff_t>(sixes) * stride_c;
  switch (n - sixes) {
    case 1:
      return multiply_columns<Real, 1>(a, rest, c, stride_c);
    case 2:
      return multiply_columns<Real, 2>(a, rest, c, stride_c);
    case 3:
      return multiply_columns<Real, 3>(a, rest, c, stride_c);
    case 4:
      return multiply_columns<Real, 4>(a, rest, c, stride_c);
    case 5:
      return multiply_columns<Real, 5>(a, rest, c, stride_c);
    default:
      return;
  }
}

/// A vector of a panel's rows in one column.
template <class Real>
using PanelPack = typename Packs<Real>::Wide;

/// Does what multiply_tile does, with one vector for a panel's rows: up to 24 sums in 32 registers. Sums are in the
/// same order, so that results are the same to the last bit.
template <class Real, int Panels, int Columns>
SUPPLE_INLINE void multiply_wide_tile(const PackedMatrix<Real>& a, int panel, const Factor<Real>& b, Real* c,
                                      int stride_c) {
  constexpr int panel_rows = PackedMatrix<Real>::panel_rows;
  PanelPack<Real> sum[Panels][Columns];
  const Real* from[Panels];
#pragma GCC unroll 16
  for (int p = 0; p < Panels; ++p) {
    from[p] = a.panel(panel + p);
#pragma GCC unroll 16
    for (int j = 0; j < Columns; ++j) sum[p][j] = PanelPack<Real>{};
  }
  const int depth = a.columns();
  for (int k = 0; k < depth; ++k) {
    PanelPack<Real> row[Panels];
#pragma GCC unroll 16
    for (int p = 0; p < Panels; ++p) std::memcpy(&row[p], from[p] + k * panel_rows, sizeof row[p]);
#pragma GCC unroll 16
    for (int j = 0; j < Columns; ++j) {
      const Real factor = b.numbers[k * b.step + j * b.stride];
#pragma GCC unroll 16
      for (int p = 0; p < Panels; ++p) sum[p][j] += row[p] * factor;
    }
  }
  Real* to = c + panel * panel_rows;
#pragma GCC unroll 16
  for (int p = 0; p < Panels; ++p)
#pragma GCC unroll 16
    for (int j = 0; j < Columns; ++j) std::memcpy(to + j * stride_c + p * panel_rows, &sum[p][j], sizeof sum[p][j]);
}

/// Computes the rows of `Columns` columns from panel `panel` on. `Panels` panels are multiplied at once, and half as
/// many where fewer remain.
template <class Real, int Panels, int Columns>
SUPPLE_INLINE void multiply_wide_columns(const PackedMatrix<Real>& a, int panel, const Factor<Real>& b, Real* c,
                                         int stride_c) {
  for (; panel + Panels <= a.panels(); panel += Panels)
    multiply_wide_tile<Real, Panels, Columns>(a, panel, b, c, stride_c);
  if constexpr (Panels > 1) multiply_wide_columns<Real, Panels / 2, Columns>(a, panel, b, c, stride_c);
}

template <class Real>
SUPPLE_INLINE void multiply_wide(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c) {
  int j = 0;
  for (; j + 6 <= n; j += 6)
    multiply_wide_columns<Real, 4, 6>(a, 0, b.from_column(j), c + static_cast<std::ptrdiff_t>(j) * stride_c, stride_c);
  const Factor<Real> rest = b.from_column(j);
  c += static_cast<std::ptrdiff_t>(j) * stride_c;
  switch (n - j) {
    case 1:
      return multiply_wide_columns<Real, 8, 1>(a, 0, rest, c, stride_c);
    case 2:
      return multiply_wide_columns<Real, 8, 2>(a, 0, rest, c, stride_c);
    case 3:
      return multiply_wide_columns<Real, 4, 3>(a, 0, rest, c, stride_c);
    case 4:
      return multiply_wide_columns<Real, 4, 4>(a, 0, rest, c, stride_c);
    case 5:
      return multiply_wide_columns<Real, 4, 5>(a, 0, rest, c, stride_c);
    default:
      return;
  }
}

template <class Real>
SUPPLE_AVX512 void multiply_avx512(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c) {
  multiply_wide(a, b, n, c, stride_c);
}
template <class Real>
SUPPLE_AVX2 void multiply_avx2(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c) {
  multiply_all(a, b, n, c, stride_c);
}
template <class Real>
void multiply_portable(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c) {
  multiply_all(a, b, n, c, stride_c);
}

}  // namespace

template <class Real>
void PackedMatrix<Real>::assign(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::Matrix<Real, -1, -1> numbers = matrix.cast<Real>();
  assign(numbers.data(), static_cast<int>(numbers.rows()), static_cast<int>(numbers.cols()),
         static_cast<int>(numbers.rows()), false);
}

template <class Real>
void PackedMatrix<Real>::assign(const Real* numbers, int rows, int columns, int stride, bool transposed) {
  rows_ = rows;
  columns_ = columns;
  numbers_.resize(static_cast<std::size_t>(padded_rows(rows)) * static_cast<std::size_t>(columns));
  const std::ptrdiff_t down = transposed ? stride : 1;
  const std::ptrdiff_t right = transposed ? 1 : stride;
  Real* to = numbers_.data();
  int first = 0;
  // Whole panels have a loop of constant length, which is faster. Training packs as often as it multiplies.
  for (; first + panel_rows <= rows; first += panel_rows)
    for (int k = 0; k < columns; ++k, to += panel_rows) {
      const Real* from = numbers + first * down + k * right;
      if (down == 1)
        std::memcpy(to, from, panel_rows * sizeof(Real));
      else
        for (int i = 0; i < panel_rows; ++i) to[i] = from[i * down];
    }
  for (; first < padded_rows(rows); first += panel_rows)
    for (int k = 0; k < columns; ++k, to += panel_rows)
      for (int i = 0; i < panel_rows; ++i) to[i] = first + i < rows ? numbers[(first + i) * down + k * right] : Real(0);
}

Instructions best_instructions() {
  return has_avx512 ? Instructions::avx512 : has_avx2 ? Instructions::avx2 : Instructions::portable;
}

template <class Real>
void multiply(const PackedMatrix<Real>& a, const Factor<Real>& b, int n, Real* c, int stride_c, Instructions use) {
  switch (use) {
    case Instructions::avx512:
      return multiply_avx512(a, b, n, c, stride_c);
    case Instructions::avx2:
      return multiply_avx2(a, b, n, c, stride_c);
    default:
      return multiply_portable(a, b, n, c, stride_c);
  }
}

template class PackedMatrix<double>;
template class PackedMatrix<float>;
template void multiply(const PackedMatrix<double>&, const Factor<double>&, int, double*, int, Instructions);
template void multiply(const PackedMatrix<float>&, const Factor<float>&, int, float*, int, Instructions);

}  // namespace supple::neural
