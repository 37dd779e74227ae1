#include "patch_stability.h"

#include "supple/base/error.h"
#include "supple/numerics/least_stable_mode.h"

namespace supple::microscale {
PatchStability::PatchStability(Eigen::Index displacements)
    : entries_{numerics::HessianEntries(displacements), numerics::HessianEntries(displacements),
               numerics::HessianEntries(displacements)} {}

std::optional<PatchStability::Instability> PatchStability::find(const CellModel& cell, const Eigen::VectorXd& x,
                                                                const Execution& execution) {
  const StageTimer timer(execution.cost, "patch stability");
  const Eigen::Index n = cell.coordinates().strain();
  for (numerics::HessianEntries& entries : entries_) entries.clear();
  cell.add_alternating_hessians(x, entries_);
  const numerics::Hessian hessian = std::shared_ptr<const numerics::BorderedMatrix>(matrix_);
  std::optional<Instability> least_stable;
  cholesky_.stop_with(execution.cancellation);
  for (std::size_t a = 0; a < alternations.size(); ++a) {
    execution.cancellation.throw_if_requested();
    entries_[a].assemble(n, *matrix_);
    if (cholesky_.factorize(hessian, 0)) continue;
    const auto mode = numerics::least_stable_mode(hessian, n, cholesky_, execution.cancellation);
    if (!mode) throw Error("minimizer.not_finite", "The stiffness of the patch of 2x2 cells is not finite.");
    if (mode->curvature < 0 && (!least_stable || mode->curvature < least_stable->curvature))
      least_stable = Instability{alternations[a], mode->direction, mode->curvature};
  }
  return least_stable;
}

Eigen::VectorXd repeat_over_patch(const Eigen::VectorXd& x) {
  const Eigen::Index n = x.size() - CellCoordinates::strain_components;
  Eigen::VectorXd patch(4 * n + CellCoordinates::strain_components);
  for (int copy = 0; copy < 4; ++copy) patch.segment(copy * n, n) = x.head(n);
  patch.tail<CellCoordinates::strain_components>() = x.tail<CellCoordinates::strain_components>();
  return patch;
}

Eigen::VectorXd repeat_over_patch(const PatchStability::Instability& instability) {
  const Eigen::Index n = instability.mode.size();
  Eigen::VectorXd patch(4 * n + CellCoordinates::strain_components);
  for (int b = 0; b < 2; ++b)
    for (int a = 0; a < 2; ++a)
      patch.segment((a + 2 * b) * n, n) = instability.alternation.sign(a, b) * instability.mode;
  patch.tail<CellCoordinates::strain_components>().setZero();
  return patch;
}

}  // namespace supple::microscale
