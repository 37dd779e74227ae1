#pragma once

#include <memory>
#include <optional>

#include "cell_model.h"
#include "supple/base/execution.h"

namespace supple::microscale {

/// Whether an equilibrium of one cell is stable in the 2x2 patch.
///
/// The patch's stability decouples into four problems of one cell, for displacements that alternate or not along either
/// translation (Bloch waves [Triantafyllidis1993]). The path that finds the equilibrium checks the mode in which all
/// cells move alike. This class checks the three others, at the cost of three factorizations.
class PatchStability {
 public:
  /// `displacements`: number of nodal displacements of one cell.
  explicit PatchStability(Eigen::Index displacements);

  struct Instability {
    Alternation alternation;
    Eigen::VectorXd mode;  ///< displacements of one cell's nodes
    double curvature = 0;
  };

  /// The least stable alternating mode at x, if it is unstable.
  std::optional<Instability> find(const CellModel& cell, const Eigen::VectorXd& x, const Execution& execution);

 private:
  AlternatingEntries entries_;
  std::shared_ptr<numerics::BorderedMatrix> matrix_ = std::make_shared<numerics::BorderedMatrix>();
  numerics::ShiftedCholesky cholesky_;
};

/// The state of one cell repeated over the 2x2 patch, in the patch's coordinates.
Eigen::VectorXd repeat_over_patch(const Eigen::VectorXd& x);
/// An alternating mode of one cell as a change of the patch's coordinates.
Eigen::VectorXd repeat_over_patch(const PatchStability::Instability& instability);

}  // namespace supple::microscale
