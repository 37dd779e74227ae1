#pragma once

#include "supple/base/cancellation.h"

namespace supple::numerics {

/// Dense kernels of the multifrontal factorization. Matrices are stored by columns with leading dimension `ld`, and
/// only lower triangles are read. One source is compiled for AVX2 and for any x86-64, and the program chooses when it
/// runs.

/// Factorizes the first `pivots` columns of the symmetric `rows` x `rows` front F = [A B^T; B C] in place: A = L L^T, B
/// <- B L^-T, C <- C - B B^T. `ld` >= rows. It takes about pivots rows^2 / 2 multiply-adds, near the machine's peak
/// rate from some dozen pivots on. Returns false if A is not numerically positive definite; the front's values are then
/// undefined. Entries up to eight columns right of the diagonal are overwritten.
///
/// Large fronts are shared among the counted threads, with the same bits for any number of them. Once a stop is
/// requested, the function ends within a few columns and returns false, with undefined values.
bool partial_cholesky(double* front, int ld, int rows, int pivots, const CancellationToken& cancellation = {});

/// Number of right-hand sides that are solved at once.
inline constexpr int solve_width = 4;

/// x holds solve_width numbers for each row: x[r * solve_width + c]. Forward: x_pivots <- L^-1 x_pivots and
/// below <- B x_pivots, for the panel [L; B] of `rows` x `pivots`. `below` has rows - pivots rows.
void panel_forward(const double* panel, int ld, int rows, int pivots, double* x, double* below);
/// Backward: x_pivots <- L^-T (x_pivots - B^T below).
void panel_backward(const double* panel, int ld, int rows, int pivots, double* x, const double* below);
/// The same for one right-hand side, where the lanes of a vector are rows. It takes a quarter of the work.
void panel_forward_one(const double* panel, int ld, int rows, int pivots, double* x, double* below);
void panel_backward_one(const double* panel, int ld, int rows, int pivots, double* x, const double* below);

}  // namespace supple::numerics
