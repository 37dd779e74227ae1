#pragma once

#include "supple/base/cancellation.h"

namespace supple::numerics {

/// Dense kernels of the multifrontal factorization. Matrices are stored by columns with leading dimension `ld`; only
/// lower triangles are read. Written once; compiled for AVX2 and for any x86-64, chosen when the program runs.

/// Factorizes the first `pivots` columns of the symmetric `rows` x `rows` front F = [A B^T; B C] in place:
/// A = L L^T, B <- B L^-T, C <- C - B B^T. rows pivots (rows - pivots) + ... multiply-adds, near the machine's rate
/// from some dozen pivots on. False, with the front spoilt, where A is not numerically positive definite. Entries above
/// the diagonal, within eight columns of it, are overwritten. `ld` >= rows.
/// Large fronts are shared among the counted threads, with the same bits for any number of them.
/// Once a stop is requested it ends at the next few columns, with the front spoilt, and returns false.
bool partial_cholesky(double* front, int ld, int rows, int pivots, const CancellationToken& cancellation = {});

/// Right-hand sides that are solved side by side.
inline constexpr int solve_width = 4;

/// x holds solve_width numbers for each row: x[r * solve_width + c]. Forward: x_pivots <- L^-1 x_pivots and
/// below <- B x_pivots, for the panel [L; B] of `rows` x `pivots`. `below` has rows - pivots rows.
void panel_forward(const double* panel, int ld, int rows, int pivots, double* x, double* below);
/// Backward: x_pivots <- L^-T (x_pivots - B^T below).
void panel_backward(const double* panel, int ld, int rows, int pivots, double* x, const double* below);
/// The same for one right-hand side, where the lanes of a vector are rows: a quarter of the work.
void panel_forward_one(const double* panel, int ld, int rows, int pivots, double* x, double* below);
void panel_backward_one(const double* panel, int ld, int rows, int pivots, double* x, const double* below);

}  // namespace supple::numerics
