#pragma once

#include <optional>

#include "cell_path.h"
#include "extrapolation.h"
#include "supple/tiling/refined_mesh.h"

namespace supple::microscale {

/// The equilibria of a coarse mesh once more where each of its triangles is divided in four. The coarse equilibrium is
/// a state of the fine mesh too, and so near to the fine equilibrium that one factorization finds it.
class FineEquilibria {
 public:
  FineEquilibria(const CellModel& coarse, const SimulationOptions& options);

  struct Found {
    PatchResponse response;
    bool same_branch = true;  ///< whether no unstable equilibrium was left on the way
  };
  /// The equilibrium next to that of the coarse mesh, under the same load and with the same contact barrier. None if
  /// there is no stable one. One factorization and two Hessians where Newton's method converges as it should.
  std::optional<Found> find(const CellPath& coarse, const FreeStrains& free, const Execution& execution);

 private:
  Eigen::VectorXd prolonged(const Eigen::VectorXd& x) const;
  void set_contact(const CellScene::Contact& contact);
  /// By Newton steps with the factorization of the first state. None where they do not converge quickly.
  std::optional<PatchResponse> correct(const Eigen::VectorXd& x, const FreeStrains& free, const Execution& execution);
  /// By the path's own minimization.
  std::optional<Found> settle(Eigen::VectorXd x, const FreeStrains& free, const CellScene::Contact& contact,
                              const Execution& execution);

  SimulationOptions options_;
  tiling::RefinedMesh refined_;
  CellModel model_;
};

}  // namespace supple::microscale
