#pragma once

#include <optional>

#include "cell_path.h"
#include "extrapolation.h"
#include "supple/tiling/refined_mesh.h"

namespace supple::microscale {

/// Finds the equilibria of a coarse mesh again on a fine mesh, on which each triangle is divided in four. The coarse
/// equilibrium is a state of the fine mesh too, and so near to the fine equilibrium that usually one factorization
/// suffices to find it.
class FineEquilibria {
 public:
  FineEquilibria(const CellModel& coarse, const SimulationOptions& options);

  struct FineEquilibrium {
    PatchResponse response;
    bool same_branch = true;  ///< whether it was found without leaving an unstable equilibrium
  };
  /// The equilibrium next to that of the coarse mesh, under the same load and with the same contact barrier. None if
  /// there is no stable one. Takes one factorization and two Hessians if Newton's method converges quickly.
  std::optional<FineEquilibrium> find(const CellPath& coarse, const FreeStrains& free, const Execution& execution);

 private:
  /// The state of the fine mesh that equals the state x of the coarse one.
  Eigen::VectorXd prolonged(const Eigen::VectorXd& x) const;
  void set_contact(const CellScene::Contact& contact);
  /// Finds the equilibrium by Newton steps with the factorization at x. None if they do not converge quickly.
  std::optional<PatchResponse> solve_by_newton(const Eigen::VectorXd& x, const FreeStrains& free,
                                               const Execution& execution);
  /// Finds the equilibrium by the minimization that the coarse path uses too.
  std::optional<FineEquilibrium> minimize(Eigen::VectorXd x, const FreeStrains& free, const CellScene::Contact& contact,
                                          const Execution& execution);

  SimulationOptions options_;
  tiling::RefinedMesh refined_;
  CellModel model_;
};

}  // namespace supple::microscale
