#pragma once

#include <array>

#include "cell_state.h"
#include "supple/numerics/term.h"

namespace supple::microscale {

/// A mode that alternates from cell to cell: w(X + lattice (a, b)) = sign w(X), with sign = -1 for odd a where `first`,
/// times -1 for odd b where `second`. Those of a 2x2 patch of cells are the four combinations; (false, false) is the
/// cell's own period.
struct Alternation {
  bool first = false;
  bool second = false;

  double sign(int a, int b) const { return ((first && a % 2 != 0) != (second && b % 2 != 0)) ? -1.0 : 1.0; }
};

/// The modes of a 2x2 patch that are not of the cell's own period.
inline constexpr std::array<Alternation, 3> alternations{{{true, false}, {false, true}, {true, true}}};
/// One Hessian for each of them.
using AlternatingEntries = std::array<numerics::HessianEntries, alternations.size()>;

/// A term of a periodic cell's energy, in the coordinates of cell_coordinates.h.
class CellTerm : public numerics::Term<CellState> {
 public:
  /// Adds the Hessians at x (of the cell's period) with respect to nodal displacements that alternate: the stability of
  /// the 2x2 patch falls apart into one such problem of one cell for each alternation (Bloch waves). No entries for F.
  virtual void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const = 0;
};

}  // namespace supple::microscale
