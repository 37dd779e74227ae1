// Vectors of four doubles are never arguments or results of external functions, so their calling convention does not
// matter.
#pragma GCC diagnostic ignored "-Wpsabi"
#include "partial_cholesky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "supple/base/lanes.h"
#include "supple/base/threads.h"

namespace supple::numerics {
namespace {

/// Number of columns that are updated together. With two vectors of rows, their sums fill half of the registers.
constexpr int block = 4;

/// Fronts from this number of rows on do not fit into the caches near a core. They are factorized in panels of columns.
/// The update of the columns to the right of a panel reads a copy of it, which is stored in the order of reading.
constexpr int min_large_front_rows = 320;
/// Number of columns of a panel. It is large, so that the columns to its right are seldom read and written, but small
/// enough for the nearest cache.
constexpr int panel_columns = 48;
/// Number of rows of a tile of the copy. A tile stores the rows of one column of the panel next to each other.
constexpr int tile_rows = 2 * lanes;
/// Number of tiles that are used for all columns in turn: about 100 kB with panel_columns columns.
constexpr int tiles_per_chunk = 32;
/// Number of columns of a part, which one thread takes; a multiple of `block`. Its update by one chunk of tiles
/// takes some tenths of a millisecond.
constexpr int columns_per_part = 64;
/// Number of rows of a part of a panel, which one thread takes; a multiple of tile_rows. With 48 columns these are
/// about 100 kB.
constexpr int rows_per_part = 256;
/// Below this number of parts, starting threads costs more than it saves.
constexpr int min_parallel_parts = 4;

/// Calls body(i) for i in [0, count), in parallel if there are enough parts.
template <class Body>
void for_each_part(int count, const Body& body) {
  if (count < min_parallel_parts) {
    for (int i = 0; i < count; ++i) body(i);
  } else {
    parallel_for(count, body);
  }
}

/// C(rows, column..column+width) -= L(rows, 0..depth) L(column..column+width, 0..depth)^T for `vectors` * 4 rows from
/// `row` on. `front` points to column `first` of the whole front, where L begins; `row` and `column` count from the
/// whole front's begin.
template <int vectors, int width>
SUPPLE_INLINE void update_tile(double* front, int ld, int row, int column, int depth, int first) {
  Lanes sum[width][vectors];
  for (int c = 0; c < width; ++c)
    for (int v = 0; v < vectors; ++v) sum[c][v] = constant_lanes(0);
  const double* left = front + row;
  const double* right = front + column;
  for (int k = 0; k < depth; ++k, left += ld, right += ld) {
    Lanes rows[vectors];
    for (int v = 0; v < vectors; ++v) rows[v] = load_lanes(left + v * lanes);
    for (int c = 0; c < width; ++c) {
      const Lanes factor = constant_lanes(right[c]);
      for (int v = 0; v < vectors; ++v) sum[c][v] += rows[v] * factor;
    }
  }
  for (int c = 0; c < width; ++c) {
    double* target = front + static_cast<std::ptrdiff_t>(column - first + c) * ld + row;
    for (int v = 0; v < vectors; ++v) store_lanes(target + v * lanes, load_lanes(target + v * lanes) - sum[c][v]);
  }
}

/// The same for the rows from `begin` up to `end`.
template <int width>
SUPPLE_INLINE void update_columns(double* front, int ld, int begin, int end, int column, int depth, int first) {
  if (depth == 0) return;
  int row = begin;
  for (; row + 2 * lanes <= end; row += 2 * lanes) update_tile<2, width>(front, ld, row, column, depth, first);
  for (; row + lanes <= end; row += lanes) update_tile<1, width>(front, ld, row, column, depth, first);
  for (; row < end; ++row) {
    double sum[width] = {};
    for (int k = 0; k < depth; ++k) {
      const double* at = front + static_cast<std::ptrdiff_t>(k) * ld;
      for (int c = 0; c < width; ++c) sum[c] += at[row] * at[column + c];
    }
    for (int c = 0; c < width; ++c) front[static_cast<std::ptrdiff_t>(column - first + c) * ld + row] -= sum[c];
  }
}

SUPPLE_INLINE void update_block(double* front, int ld, int begin, int end, int column, int width, int depth,
                                int first = 0) {
  switch (width) {
    case 1:
      return update_columns<1>(front, ld, begin, end, column, depth, first);
    case 2:
      return update_columns<2>(front, ld, begin, end, column, depth, first);
    case 3:
      return update_columns<3>(front, ld, begin, end, column, depth, first);
    default:
      return update_columns<4>(front, ld, begin, end, column, depth, first);
  }
}

/// Subtracts the contributions of the columns from `column` up to `c` from column c, in the rows from `begin` up to
/// `end`.
SUPPLE_INLINE void subtract_earlier(double* front, int ld, int begin, int end, int column, int c) {
  double* at = front + static_cast<std::ptrdiff_t>(c) * ld;
  for (int k = column; k < c; ++k) {
    const double* earlier = front + static_cast<std::ptrdiff_t>(k) * ld;
    const double factor = earlier[c];
    int row = begin;
    const Lanes factors = constant_lanes(factor);
    for (; row + lanes <= end; row += lanes)
      store_lanes(at + row, load_lanes(at + row) - factors * load_lanes(earlier + row));
    for (; row < end; ++row) at[row] -= factor * earlier[row];
  }
}

SUPPLE_INLINE void scale_rows(double* at, int begin, int end, double factor) {
  int row = begin;
  const Lanes factors = constant_lanes(factor);
  for (; row + lanes <= end; row += lanes) store_lanes(at + row, load_lanes(at + row) * factors);
  for (; row < end; ++row) at[row] *= factor;
}

/// Factorizes the `width` columns from `column` on, which have received the updates by all columns before them.
SUPPLE_INLINE bool factorize_block(double* front, int ld, int rows, int column, int width) {
  for (int c = column; c < column + width; ++c) {
    double* column_values = front + static_cast<std::ptrdiff_t>(c) * ld;
    subtract_earlier(front, ld, c, rows, column, c);
    const double pivot = column_values[c];
    if (!(pivot > 0) || !std::isfinite(pivot)) return false;
    const double root = std::sqrt(pivot);
    column_values[c] = root;
    scale_rows(column_values, c + 1, rows, 1 / root);
  }
  return true;
}

/// Continues factorize_block in the rows from `begin` up to `end`, which lie below the rows that it was called with.
SUPPLE_INLINE void solve_block(double* front, int ld, int begin, int end, int column, int width) {
  for (int c = column; c < column + width; ++c) {
    double* column_values = front + static_cast<std::ptrdiff_t>(c) * ld;
    subtract_earlier(front, ld, begin, end, column, c);
    scale_rows(column_values, begin, end, 1 / column_values[c]);
  }
}

/// sum = left right^T for 8 rows and 4 columns, over `depth` columns of the two tiles.
SUPPLE_INLINE void multiply_tiles(const double* left, const double* right, int depth, Lanes sum[block][2]) {
  for (int c = 0; c < block; ++c) sum[c][0] = sum[c][1] = constant_lanes(0);
  for (int k = 0; k < depth; ++k, left += tile_rows, right += tile_rows) {
    const Lanes upper = load_lanes(left);
    const Lanes lower = load_lanes(left + lanes);
    for (int c = 0; c < block; ++c) {
      const Lanes factor = constant_lanes(right[c]);
      sum[c][0] += upper * factor;
      sum[c][1] += lower * factor;
    }
  }
}

/// Copies the rows from `begin` up to `rows` of `width` columns of a front to tiles. Missing rows of the last tile are
/// 0.
SUPPLE_INLINE void copy_tiles(const double* panel, int ld, int begin, int rows, int width, double* copy) {
  for (int row = begin; row < rows; row += tile_rows)
    for (int k = 0; k < width; ++k, copy += tile_rows) {
      const double* at = panel + static_cast<std::ptrdiff_t>(k) * ld + row;
      const int count = std::min(tile_rows, rows - row);
      for (int r = 0; r < count; ++r) copy[r] = at[r];
      for (int r = count; r < tile_rows; ++r) copy[r] = 0;
    }
}

/// The update of the columns to the right of a panel, in the rows and columns from `begin` on.
struct PanelUpdate {
  double* front;
  int ld, begin, rows;
  int depth;           ///< number of columns of the panel
  const double* copy;  ///< the panel's rows from `begin` on, as tiles

  int tiles() const { return (rows - begin + tile_rows - 1) / tile_rows; }
  const double* tile(int number) const { return copy + static_cast<std::ptrdiff_t>(number) * tile_rows * depth; }
};

/// A part of the lower triangle, counted from `begin`: some tiles of rows, and some columns.
struct TrianglePart {
  int first_tile, end_tile;
  int first_column, end_column;
};

/// Subtracts the products of a panel's rows from a part of the lower triangle. Entries above the diagonal are
/// overwritten.
SUPPLE_INLINE void subtract_part(const PanelUpdate& update, const TrianglePart& part,
                                 const CancellationToken& cancellation) {
  const auto [front, ld, begin, rows, depth, copy] = update;
  for (int column = part.first_column; column < part.end_column; column += block) {
    if (cancellation.requested()) return;
    const double* right = update.tile(column / tile_rows) + column % tile_rows;
    for (int tile = std::max(part.first_tile, column / tile_rows); tile < part.end_tile; ++tile) {
      Lanes sum[block][2];
      multiply_tiles(update.tile(tile), right, depth, sum);
      const int row = begin + tile * tile_rows;
      double* to = front + static_cast<std::ptrdiff_t>(begin + column) * ld + row;
      if (row + tile_rows <= rows && begin + column + block <= rows) {
        for (int c = 0; c < block; ++c, to += ld) {
          store_lanes(to, load_lanes(to) - sum[c][0]);
          store_lanes(to + lanes, load_lanes(to + lanes) - sum[c][1]);
        }
        continue;
      }
      for (int c = 0; c < std::min(block, rows - begin - column); ++c, to += ld)
        for (int r = 0; r < std::min(tile_rows, rows - row); ++r) to[r] -= sum[c][r / lanes][r % lanes];
    }
  }
}
SUPPLE_AVX2 void subtract_part_avx2(const PanelUpdate& update, const TrianglePart& part,
                                    const CancellationToken& cancellation) {
  subtract_part(update, part, cancellation);
}

/// Updates the whole lower triangle, in parallel if it is large. Each entry is changed once and in the same way by any
/// thread. Returns false if a stop was requested.
bool subtract_panel(const PanelUpdate& update, const CancellationToken& cancellation) {
  std::vector<TrianglePart> parts;
  const int tiles = update.tiles();
  // The largest parts come first, so that no thread ends long after the others.
  for (int chunk = (tiles - 1) / tiles_per_chunk * tiles_per_chunk; chunk >= 0; chunk -= tiles_per_chunk) {
    const int end = std::min(tiles, chunk + tiles_per_chunk);
    const int columns = std::min(update.rows - update.begin, end * tile_rows);
    for (int column = 0; column < columns; column += columns_per_part)
      parts.push_back({chunk, end, column, std::min(columns, column + columns_per_part)});
  }
  for_each_part(static_cast<int>(parts.size()), [&](int number) {
    const TrianglePart& part = parts[static_cast<std::size_t>(number)];
    has_avx2 ? subtract_part_avx2(update, part, cancellation) : subtract_part(update, part, cancellation);
  });
  return !cancellation.requested();
}

/// The columns of a front from `first` up to `end`, whose rows above `end` are factorized.
struct Panel {
  double* front;
  int ld, first, end;
  double* begin() const { return front + static_cast<std::ptrdiff_t>(first) * ld; }
};

/// Factorizes some rows of a panel, and copies them to tiles. `copy` begins with the tile of row `end`.
SUPPLE_INLINE void finish_rows(const Panel& panel, int begin, int end, double* copy) {
  for (int column = panel.first; column < panel.end; column += block) {
    const int width = std::min(block, panel.end - column);
    // The pointer begins at the panel's first column, so that only the panel's columns are multiplied.
    update_block(panel.begin(), panel.ld, begin, end, column, width, column - panel.first, panel.first);
    solve_block(panel.front, panel.ld, begin, end, column, width);
  }
  const int width = panel.end - panel.first;
  copy_tiles(panel.begin(), panel.ld, begin, end, width, copy + static_cast<std::ptrdiff_t>(begin - panel.end) * width);
}
SUPPLE_AVX2 void finish_rows_avx2(const Panel& panel, int begin, int end, double* copy) {
  finish_rows(panel, begin, end, copy);
}

SUPPLE_INLINE bool factorize_large_front(double* front, int ld, int rows, int pivots,
                                         const CancellationToken& cancellation) {
  // The buffer is reused by later fronts: allocating it costs as much as factorizing some of the smaller ones.
  thread_local std::vector<double> copy;
  for (int first = 0; first < pivots; first += panel_columns) {
    if (cancellation.requested()) return false;
    const int end = std::min(pivots, first + panel_columns);
    const Panel panel{front, ld, first, end};
    for (int column = first; column < end; column += block) {
      const int width = std::min(block, end - column);
      update_block(panel.begin(), ld, column, end, column, width, column - first, first);
      if (!factorize_block(front, ld, end, column, width)) return false;
    }
    if (end == rows) break;
    copy.resize(static_cast<std::size_t>(rows - end + tile_rows) * panel_columns);
    for_each_part((rows - end + rows_per_part - 1) / rows_per_part, [&, to = copy.data()](int part) {
      if (cancellation.requested()) return;
      const int from = end + part * rows_per_part;
      const int until = std::min(rows, from + rows_per_part);
      has_avx2 ? finish_rows_avx2(panel, from, until, to) : finish_rows(panel, from, until, to);
    });
    if (!subtract_panel({front, ld, end, rows, end - first, copy.data()}, cancellation)) return false;
  }
  return true;
}

SUPPLE_INLINE bool factorize_front(double* front, int ld, int rows, int pivots, const CancellationToken& cancellation) {
  if (rows >= min_large_front_rows) return factorize_large_front(front, ld, rows, pivots, cancellation);
  for (int column = 0; column < pivots; column += block) {
    if (cancellation.requested()) return false;
    const int width = pivots - column < block ? pivots - column : block;
    update_block(front, ld, column, rows, column, width, column);
    if (!factorize_block(front, ld, rows, column, width)) return false;
  }
  for (int column = pivots; column < rows; column += block) {
    if (cancellation.requested()) return false;
    update_block(front, ld, column, rows, column, rows - column < block ? rows - column : block, pivots);
  }
  return true;
}

/// below(row..row+height) = B(row..row+height, :) x.
template <int height>
SUPPLE_INLINE void multiply_rows(const double* panel, int ld, int row, int pivots, const double* x, double* below) {
  Lanes sum[height];
  for (int r = 0; r < height; ++r) sum[r] = constant_lanes(0);
  const double* at = panel + row;
  for (int k = 0; k < pivots; ++k, at += ld) {
    const Lanes value = load_lanes(x + k * solve_width);
    for (int r = 0; r < height; ++r) sum[r] += constant_lanes(at[r]) * value;
  }
  for (int r = 0; r < height; ++r) store_lanes(below + (row - pivots + r) * solve_width, sum[r]);
}

SUPPLE_INLINE void forward(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
  for (int k = 0; k < pivots; ++k) {
    const double* column = panel + static_cast<std::ptrdiff_t>(k) * ld;
    const Lanes value = load_lanes(x + k * solve_width) * constant_lanes(1 / column[k]);
    store_lanes(x + k * solve_width, value);
    for (int r = k + 1; r < pivots; ++r)
      store_lanes(x + r * solve_width, load_lanes(x + r * solve_width) - constant_lanes(column[r]) * value);
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
    sum[c] = constant_lanes(0);
    at[c] = panel + static_cast<std::ptrdiff_t>(column + c) * ld;
  }
  for (int r = begin; r < rows; ++r) {
    const Lanes value = load_lanes(y + (r - begin) * solve_width);
    for (int c = 0; c < width; ++c) sum[c] += constant_lanes(at[c][r]) * value;
  }
  for (int c = 0; c < width; ++c)
    store_lanes(x + (column + c) * solve_width, load_lanes(x + (column + c) * solve_width) - sum[c]);
}

SUPPLE_INLINE void backward(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
  int column = 0;
  for (; column + 4 <= pivots; column += 4) subtract_products<4>(panel, ld, pivots, rows, column, x, below);
  for (; column < pivots; ++column) subtract_products<1>(panel, ld, pivots, rows, column, x, below);
  for (int k = pivots - 1; k >= 0; --k) {
    subtract_products<1>(panel, ld, k + 1, pivots, k, x, x + (k + 1) * solve_width);
    const double diagonal = panel[static_cast<std::ptrdiff_t>(k) * ld + k];
    store_lanes(x + k * solve_width, load_lanes(x + k * solve_width) * constant_lanes(1 / diagonal));
  }
}

/// below = B(row..row+4 * vectors, :) x for one right-hand side.
template <int vectors>
SUPPLE_INLINE void multiply_rows_one(const double* panel, int ld, int row, int pivots, const double* x, double* below) {
  Lanes sum[vectors];
  for (int v = 0; v < vectors; ++v) sum[v] = constant_lanes(0);
  const double* at = panel + row;
  for (int k = 0; k < pivots; ++k, at += ld) {
    const Lanes value = constant_lanes(x[k]);
    for (int v = 0; v < vectors; ++v) sum[v] += load_lanes(at + v * lanes) * value;
  }
  for (int v = 0; v < vectors; ++v) store_lanes(below + row - pivots + v * lanes, sum[v]);
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
    sum[c] = constant_lanes(0);
    at[c] = panel + static_cast<std::ptrdiff_t>(column + c) * ld;
  }
  int r = begin;
  for (; r + lanes <= rows; r += lanes) {
    const Lanes value = load_lanes(y + (r - begin));
    for (int c = 0; c < width; ++c) sum[c] += load_lanes(at[c] + r) * value;
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

SUPPLE_AVX2 bool factorize_avx2(double* front, int ld, int rows, int pivots, const CancellationToken& cancellation) {
  return factorize_front(front, ld, rows, pivots, cancellation);
}
SUPPLE_AVX2 void forward_avx2(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
  forward(panel, ld, rows, pivots, x, below);
}
SUPPLE_AVX2 void backward_avx2(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
  backward(panel, ld, rows, pivots, x, below);
}

SUPPLE_AVX2 void forward_one_avx2(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
  forward_one(panel, ld, rows, pivots, x, below);
}
SUPPLE_AVX2 void backward_one_avx2(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
  backward_one(panel, ld, rows, pivots, x, below);
}

}  // namespace

bool partial_cholesky(double* front, int ld, int rows, int pivots, const CancellationToken& cancellation) {
  if (has_avx2) return factorize_avx2(front, ld, rows, pivots, cancellation);
  return factorize_front(front, ld, rows, pivots, cancellation);
}

void panel_forward(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
  if (has_avx2) return forward_avx2(panel, ld, rows, pivots, x, below);
  forward(panel, ld, rows, pivots, x, below);
}

void panel_backward(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
  if (has_avx2) return backward_avx2(panel, ld, rows, pivots, x, below);
  backward(panel, ld, rows, pivots, x, below);
}

void panel_forward_one(const double* panel, int ld, int rows, int pivots, double* x, double* below) {
  if (has_avx2) return forward_one_avx2(panel, ld, rows, pivots, x, below);
  forward_one(panel, ld, rows, pivots, x, below);
}

void panel_backward_one(const double* panel, int ld, int rows, int pivots, double* x, const double* below) {
  if (has_avx2) return backward_one_avx2(panel, ld, rows, pivots, x, below);
  backward_one(panel, ld, rows, pivots, x, below);
}

}  // namespace supple::numerics
