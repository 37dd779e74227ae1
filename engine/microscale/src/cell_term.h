#pragma once

#include <array>

#include "cell_state.h"
#include "supple/numerics/term.h"

namespace supple::microscale {

/// How a mode alternates from cell to cell: w(X + lattice (a, b)) = sign w(X). The sign is a product of -1 if `first`
/// is set and a is odd, and of -1 if `second` is set and b is odd. The modes of a 2x2 patch of cells have the four
/// combinations. In (false, false) all cells move alike.
struct Alternation {
  bool first = false;
  bool second = false;

  double sign(int a, int b) const { return ((first && a % 2 != 0) != (second && b % 2 != 0)) ? -1.0 : 1.0; }
};

/// The modes of a 2x2 patch in which the cells do not all move alike.
inline constexpr std::array<Alternation, 3> alternations{{{true, false}, {false, true}, {true, true}}};
/// One Hessian for each entry of `alternations`.
using AlternatingEntries = std::array<numerics::HessianEntries, alternations.size()>;

/// A term of a periodic cell's energy, in the coordinates of cell_coordinates.h.
class CellTerm : public numerics::Term<CellState> {
 public:
  /// Adds the Hessians with respect to nodal displacements that alternate, at a state x in which all cells are alike.
  /// The stability of the 2x2 patch decouples into one such problem of one cell for each alternation (Bloch waves).
  /// There are no entries for F.
  virtual void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const = 0;
};

}  // namespace supple::microscale
