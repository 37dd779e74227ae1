// Vectors of four doubles never leave this file's functions by value, so that their calling convention does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"
#include "partial_cholesky.h"

#include <cmath>
#include <cstring>

#define SUPPLE_INLINE inline __attribute__((always_inline))

namespace supple::numerics {
namespace {

using Lanes = double __attribute__((vector_size(4 * sizeof(double))));
constexpr int lanes = 4;
/// Columns that are updated together: with two vectors of rows their sums fill half of the registers.
constexpr int block = 4;

SUPPLE_INLINE Lanes load(const double* from) {
  Lanes value;
  std::memcpy(&value, from, sizeof value);
  return value;
}
SUPPLE_INLINE void store(double* to, const Lanes& value) { std::memcpy(to, &value, sizeof value); }
SUPPLE_INLINE Lanes constant(double value) { return Lanes{value, value, value, value}; }

/// C(rows, column..column+width) -= L(rows, 0..depth) L(column..column+width, 0..depth)^T for `vectors` * 4 rows.
template <int vectors, int width>
SUPPLE_INLINE void update_tile(double* front, int ld, int row, int column, int depth) {
  Lanes sum[width][vectors];
  for (int c = 0; c < width; ++c)
    for (int v = 0; v < vectors; ++v) sum[c][v] = constant(0);
  const double* left = front + row;
  const double* right = front + column;
  for (int k = 0; k < depth; ++k, left += ld, right += ld) {
    Lanes rows[vectors];
    for (int v = 0; v < vectors; ++v) rows[v] = load(left + v * lanes);
    for (int c = 0; c < width; ++c) {
      const Lanes factor = constant(right[c]);
      for (int v = 0; v < vectors; ++v) sum[c][v] += rows[v] * factor;
    }
  }
  for (int c = 0; c < width; ++c) {
    double* to = front + static_cast<std::ptrdiff_t>(column + c) * ld + row;
    for (int v = 0; v < vectors; ++v) store(to + v * lanes, load(to + v * lanes) - sum[c][v]);
  }
}

template <int width>
SUPPLE_INLINE void update_columns(double* front, int ld, int rows, int column, int depth) {
  if (depth == 0) return;
  int row = column;
  for (; row + 2 * lanes <= rows; row += 2 * lanes) update_tile<2, width>(front, ld, row, column, depth);
  for (; row + lanes <= rows; row += lanes) update_tile<1, width>(front, ld, row, column, depth);
  for (; row < rows; ++row) {
    double sum[width] = {};
    for (int k = 0; k < depth; ++k) {
      const double* at = front + static_cast<std::ptrdiff_t>(k) * ld;
      for (int c = 0; c < width; ++c) sum[c] += at[row] * at[column + c];
    }
    for (int c = 0; c < width; ++c) front[static_cast<std::ptrdiff_t>(column + c) * ld + row] -= sum[c];
  }
}

SUPPLE_INLINE void update_block(double* front, int ld, int rows, int column, int width, int depth) {
  switch (width) {
    case 1:
      return update_columns<1>(front, ld, rows, column, depth);
    case 2:
      return update_columns<2>(front, ld, rows, column, depth);
    case 3:
      return update_columns<3>(front, ld, rows, column, depth);
    default:
      return update_columns<4>(front, ld, rows, column, depth);
  }
}

/// Cholesky factorization of `width` columns from `column` on whose updates have been made.
SUPPLE_INLINE bool factorize_block(double* front, int ld, int rows, int column, int width) {
  for (int c = column; c < column + width; ++c) {
    double* at = front + static_cast<std::ptrdiff_t>(c) * ld;
    for (int k = column; k < c; ++k) {
      const double* earlier = front + static_cast<std::ptrdiff_t>(k) * ld;
      const double factor = earlier[c];
      int row = c;
      const Lanes factors = constant(factor);
      for (; row + lanes <= rows; row += lanes) store(at + row, load(at + row) - factors * load(earlier + row));
      for (; row < rows; ++row) at[row] -= factor * earlier[row];
    }
    const double pivot = at[c];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    const double root = std::sqrt(pivot);
    const double inverse = 1 / root;
    at[c] = root;
    int row = c + 1;
    const Lanes inverses = constant(inverse);
    for (; row + lanes <= rows; row += lanes) store(at + row, load(at + row) * inverses);
    for (; row < rows; ++row) at[row] *= inverse;
  }
  return true;
}

SUPPLE_INLINE bool factorize_front(double* front, int ld, int rows, int pivots) {
  for (int column = 0; column < pivots; column += block) {
    const int width = pivots - column < block ? pivots - column : block;
    update_block(front, ld, rows, column, width, column);
    if (!factorize_block(front, ld, rows, column, width)) return false;
  }
  for (int column = pivots; column < rows; column += block)
    update_block(front, ld, rows, column, rows - column < block ? rows - column : block, pivots);
  return true;
}

/// below(row..row+height) = B(row..row+height, :) x.
template <int height>
SUPPLE_INLINE void multiply_rows(const double* panel, int ld, int row, int pivots, const double* x, double* below) {
  Lanes sum[height];
  for (int r = 0; r < height; ++r) sum[r] = constant(0);
  const double* at = panel + row;
  for (int k = 0; k < pivots; ++k, at += ld) {
    const Lanes value = load(x + k * solve_width);
    for (int r = 0; r < height; ++r) sum[r] += constant(at[r]) * value;
  }
  for (int r = 0; r < height; ++r) store(below + (row - pivots + r) * solve_width, sum[r]);
}

SUPPLE_INLINE void forward(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
  for (int k = 0; k < pivots; ++k) {
    const double* column = panel + static_cast<std::ptrdiff_t>(k) * ld;
    const Lanes value = load(x + k * solve_width) * constant(1 / column[k]);
    store(x + k * solve_width, value);
    for (int r = k + 1; r < pivots; ++r)
      store(x + r * solve_width, load(x + r * solve_width) - constant(column[r]) * value);
  }
  int row = pivots;
  for (; row + 4 <= rows; row += 4) multiply_rows<4>(panel, ld, row, pivots, x, below);
  for (; row < rows; ++row) multiply_rows<1>(panel, ld, row, pivots, x, below);
}

/// x(column..column+width) -= B(:, column..column+width)^T y for the rows from `begin` on; y begins with that row.
template <int width>
SUPPLE_INLINE void subtract_products(const double* panel, int ld, int begin, int rows, int column, double* x,
                                     const double* y) {
  Lanes sum[width];
  const double* at[width];
  for (int c = 0; c < width; ++c) {
    sum[c] = constant(0);
    at[c] = panel + static_cast<std::ptrdiff_t>(column + c) * ld;
  }
  for (int r = begin; r < rows; ++r) {
    const Lanes value = load(y + (r - begin) * solve_width);
    for (int c = 0; c < width; ++c) sum[c] += constant(at[c][r]) * value;
  }
  for (int c = 0; c < width; ++c) store(x + (column + c) * solve_width, load(x + (column + c) * solve_width) - sum[c]);
}

SUPPLE_INLINE void backward(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
  int column = 0;
  for (; column + 4 <= pivots; column += 4) subtract_products<4>(panel, ld, pivots, rows, column, x, below);
  for (; column < pivots; ++column) subtract_products<1>(panel, ld, pivots, rows, column, x, below);
  for (int k = pivots - 1; k >= 0; --k) {
    subtract_products<1>(panel, ld, k + 1, pivots, k, x, x + (k + 1) * solve_width);
    const double diagonal = panel[static_cast<std::ptrdiff_t>(k) * ld + k];
    store(x + k * solve_width, load(x + k * solve_width) * constant(1 / diagonal));
  }
}

/// below = B(row..row+4 * vectors, :) x for one right-hand side.
template <int vectors>
SUPPLE_INLINE void multiply_rows_one(const double* panel, int ld, int row, int pivots, const double* x, double* below) {
  Lanes sum[vectors];
  for (int v = 0; v < vectors; ++v) sum[v] = constant(0);
  const double* at = panel + row;
  for (int k = 0; k < pivots; ++k, at += ld) {
    const Lanes value = constant(x[k]);
    for (int v = 0; v < vectors; ++v) sum[v] += load(at + v * lanes) * value;
  }
  for (int v = 0; v < vectors; ++v) store(below + row - pivots + v * lanes, sum[v]);
}

SUPPLE_INLINE void forward_one(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
  for (int k = 0; k < pivots; ++k) {
    const double* column = panel + static_cast<std::ptrdiff_t>(k) * ld;
    const double value = x[k] / column[k];
    x[k] = value;
    for (int r = k + 1; r < pivots; ++r) x[r] -= column[r] * value;
  }
  int row = pivots;
  for (; row + 4 * lanes <= rows; row += 4 * lanes) multiply_rows_one<4>(panel, ld, row, pivots, x, below);
  for (; row + lanes <= rows; row += lanes) multiply_rows_one<1>(panel, ld, row, pivots, x, below);
  for (; row < rows; ++row) {
    double sum = 0;
    for (int k = 0; k < pivots; ++k) sum += panel[static_cast<std::ptrdiff_t>(k) * ld + row] * x[k];
    below[row - pivots] = sum;
  }
}

/// x(column..column+width) -= B(:, column..column+width)^T y for the rows from `begin` on; y begins with that row.
template <int width>
SUPPLE_INLINE void subtract_products_one(const double* panel, int ld, int begin, int rows, int column, double* x,
                                         const double* y) {
  Lanes sum[width];
  const double* at[width];
  for (int c = 0; c < width; ++c) {
    sum[c] = constant(0);
    at[c] = panel + static_cast<std::ptrdiff_t>(column + c) * ld;
  }
  int r = begin;
  for (; r + lanes <= rows; r += lanes) {
    const Lanes value = load(y + (r - begin));
    for (int c = 0; c < width; ++c) sum[c] += load(at[c] + r) * value;
  }
  for (int c = 0; c < width; ++c) {
    double total = (sum[c][0] + sum[c][1]) + (sum[c][2] + sum[c][3]);
    for (int rest = r; rest < rows; ++rest) total += at[c][rest] * y[rest - begin];
    x[column + c] -= total;
  }
}

SUPPLE_INLINE void backward_one(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
  int column = 0;
  for (; column + 4 <= pivots; column += 4) subtract_products_one<4>(panel, ld, pivots, rows, column, x, below);
  for (; column < pivots; ++column) subtract_products_one<1>(panel, ld, pivots, rows, column, x, below);
  for (int k = pivots - 1; k >= 0; --k) {
    subtract_products_one<1>(panel, ld, k + 1, pivots, k, x, x + k + 1);
    x[k] /= panel[static_cast<std::ptrdiff_t>(k) * ld + k];
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) bool factorize_avx2(double* front, int ld, int rows, int pivots) {
  return factorize_front(front, ld, rows, pivots);
}
__attribute__((target("avx2,fma"))) void forward_avx2(const double* panel, int ld, int rows, int pivots, double* x,
                                                      double* below) {
  forward(panel, ld, rows, pivots, x, below);
}
__attribute__((target("avx2,fma"))) void backward_avx2(const double* panel, int ld, int rows, int pivots, double* x,
                                                       const double* below) {
  backward(panel, ld, rows, pivots, x, below);
}

__attribute__((target("avx2,fma"))) void forward_one_avx2(const double* panel, int ld, int rows, int pivots, double* x,
                                                          double* below) {
  forward_one(panel, ld, rows, pivots, x, below);
}
__attribute__((target("avx2,fma"))) void backward_one_avx2(const double* panel, int ld, int rows, int pivots, double* x,
                                                           const double* below) {
  backward_one(panel, ld, rows, pivots, x, below);
}

const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif

}  // namespace

bool partial_cholesky(double* front, int ld, int rows, int pivots) {
#if defined(__x86_64__)
  if (has_avx2) return factorize_avx2(front, ld, rows, pivots);
#endif
  return factorize_front(front, ld, rows, pivots);
}

void panel_forward(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
#if defined(__x86_64__)
  if (has_avx2) return forward_avx2(panel, ld, rows, pivots, x, below);
#endif
  forward(panel, ld, rows, pivots, x, below);
}

void panel_backward(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
#if defined(__x86_64__)
  if (has_avx2) return backward_avx2(panel, ld, rows, pivots, x, below);
#endif
  backward(panel, ld, rows, pivots, x, below);
}

void panel_forward_one(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
#if defined(__x86_64__)
  if (has_avx2) return forward_one_avx2(panel, ld, rows, pivots, x, below);
#endif
  forward_one(panel, ld, rows, pivots, x, below);
}

void panel_backward_one(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
#if defined(__x86_64__)
  if (has_avx2) return backward_one_avx2(panel, ld, rows, pivots, x, below);
#endif
  backward_one(panel, ld, rows, pivots, x, below);
}

}  // namespace supple::numerics
