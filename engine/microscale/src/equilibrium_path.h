#pragma once

#include <optional>
#include <vector>

#include "cell_objective.h"
#include "supple/base/execution.h"
#include "supple/microscale/simulation.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/minimizer.h"

namespace supple::microscale {

/// Follows stable equilibria of one patch while the macroscopic strain changes.
///
/// Every internal load step predicts the next state from the tangents of the last two equilibria (cubic Hermite
/// extrapolation, or linear), minimizes the energy with Newton's method, and looks at the tangent stiffness: where it
/// is not positive definite the state is left along its least stable mode, to the equilibrium of lower energy.
class EquilibriumPath {
 public:
  /// Starts from `x`, which must be valid for the model. All references outlive the path.
  EquilibriumPath(CellModel& model, Eigen::VectorXd x, CellObjective::FreeStrains free,
                  const SimulationOptions& options, const Execution& execution);
  ~EquilibriumPath() { cholesky_.bill_to(nullptr); }
  EquilibriumPath(const EquilibriumPath&) = delete;
  EquilibriumPath& operator=(const EquilibriumPath&) = delete;

  /// Finds an equilibrium at the present strain.
  bool settle();

  enum class Progress { arrived, underway, failed };
  /// One internal load step towards the prescribed components of `target` (a deformation gradient).
  Progress step_towards(const Eigen::Matrix2d& target);

  /// Adds `mode` (a change of x) to the state, as far as the energy falls, and settles. False where it falls nowhere.
  bool leave_along(const Eigen::VectorXd& mode);

  /// Makes the contact barrier's range less and less, until the equilibrium at the same strain no longer changes or
  /// nothing is within it: what is left of the barrier is contact. Where an equilibrium is not found, or only on
  /// another branch, the one of the range before stays.
  void tighten_contact();
  /// Goes back to the equilibrium as it was before, from which the path goes on, since wide barriers are easier to
  /// follow.
  void loosen_contact();

  // At the last equilibrium:
  const Eigen::VectorXd& x() const { return objective_.x(); }
  struct Equilibrium {
    Eigen::Vector4d strain_gradient = Eigen::Vector4d::Zero();  ///< dE / dF
    /// d2 E / dF2 of the minimized energy (a Schur complement), components as in CellCoordinates.
    Eigen::Matrix4d condensed = Eigen::Matrix4d::Zero();
    Eigen::MatrixXd response;  ///< dw / dF, one column for each component of F
    double energy = 0;
    double residual = 0;
    bool stable = true;
  };
  const Equilibrium& equilibrium() const { return at_; }
  /// How the last attempt ended; where it failed the equilibrium is the one before it.
  Stop stopped() const { return stopped_; }
  Eigen::Index unknowns() const { return objective_.dimension(); }

  // Since the last call:
  struct Counts {
    int iterations = 0;
    int load_steps = 0;
    int branches_left = 0;
  };
  Counts take_counts();

 private:
  /// `left`: the state is one to which an unstable one was left, and may be far from equilibrium.
  bool minimize_energy(bool left);
  double gradient_tolerance() const;
  bool raise_contact_stiffness();
  /// Finds the equilibrium for a barrier of another range; false, and the state is undefined, where there is none.
  bool settle_with_range(double range);
  /// False where the equilibrium is not stable.
  bool finish_equilibrium(const numerics::MinimizerResult& result);
  bool finish_unstable_equilibrium();
  /// Both move to a state of less energy; false, and the state is as it was, where there is none.
  bool leave_least_stable_mode();
  bool move_along(const Eigen::VectorXd& mode);
  /// K^-1 dg/dF by the last factorization and iterative refinement; false if that is too far from K.
  bool solve_for_strains();
  void condense();
  /// The state on x + a mode (either sign of a) of least energy, found by doubling |a|.
  std::optional<Eigen::VectorXd> lowest_along(const Eigen::VectorXd& mode);
  /// The change of x for a change of the prescribed components of F, to first order.
  Eigen::VectorXd tangent(const Eigen::Vector4d& change) const;
  Eigen::Vector4d prescribed_part(const Eigen::Vector4d& change) const;
  /// States that may lie near the equilibrium after `share` of `change`.
  std::vector<Eigen::VectorXd> predictions(double share, const Eigen::Vector4d& change,
                                           const Eigen::VectorXd& along) const;
  bool try_increment(double share, const Eigen::Vector4d& change, const Eigen::VectorXd& along);

  CellModel& model_;
  const SimulationOptions& options_;
  const Execution& execution_;
  numerics::ShiftedCholesky& cholesky_;

  Equilibrium at_;
  /// The equilibrium before the last one on the same branch, with the tangent there along `travelled` (the change of F
  /// since).
  struct Previous {
    Eigen::Vector4d travelled;
    Eigen::VectorXd x;
    Eigen::VectorXd tangent;  ///< change of x to first order for all of `travelled`
  };
  std::optional<Previous> previous_;
  CellObjective objective_;

  /// As the path was before its contact was tightened.
  struct Loose {
    Eigen::VectorXd x;
    Equilibrium at;
    Stop stopped;
    double stiffness;
    double range;
  };
  Loose snapshot() const;
  void restore(const Loose& loose);
  std::optional<Loose> loose_;

  double step_ = 0;  ///< size of the next internal load step
  Counts counts_;
  Stop stopped_ = Stop::converged;
};

}  // namespace supple::microscale
