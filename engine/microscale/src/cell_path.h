#pragma once

#include <optional>
#include <vector>

#include "cell_system.h"
#include "supple/base/execution.h"
#include "supple/microscale/simulation.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/equilibrium_path.h"

namespace supple::microscale {

/// What is worked out at an equilibrium of a patch.
struct CellEquilibrium {
  Eigen::Vector4d strain_gradient = Eigen::Vector4d::Zero();  ///< dE / dF
  /// d2 E / dF2 of the minimized energy (a Schur complement), components as in CellCoordinates.
  Eigen::Matrix4d condensed = Eigen::Matrix4d::Zero();
  Eigen::MatrixXd response;  ///< dw / dF of the unknowns, one column for each component of F
  double energy = 0;
  double residual = 0;
};

/// A patch whose macroscopic strain changes, for numerics::EquilibriumPath: states ahead are guessed from the tangents
/// of the last two equilibria (cubic Hermite extrapolation, or linear), and at each equilibrium the displacements are
/// condensed out.
class CellScene {
 public:
  CellScene(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const SimulationOptions& options,
            const Execution& execution);
  ~CellScene() { cholesky().bill_to(nullptr); }
  CellScene(const CellScene&) = delete;
  CellScene& operator=(const CellScene&) = delete;

  struct State {
    Eigen::VectorXd x;
    CellEquilibrium at;
  };
  CellSystem& objective() { return system_; }
  numerics::ShiftedCholesky& cholesky() { return model_.workspace().cholesky; }
  State state() const { return {x(), at_}; }
  void set_state(State state);
  double gradient_tolerance() const;
  bool unsettled(const numerics::MinimizerResult& result);
  bool finish(const numerics::MinimizerResult& result);
  bool finish_unstable();
  void begin_step();
  bool predict(double share);
  void arrived(const numerics::Arrival& arrival);
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return system_.expand(y); }
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const;  ///< whose largest displacement is a beam width
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount);
  void left_branch();

  /// Says what the next load steps change: the prescribed components of F, to those of `target`. The change's size.
  double announce(const Eigen::Matrix2d& target);

  const Eigen::VectorXd& x() const { return system_.state().x; }
  const CellEquilibrium& at() const { return at_; }

  /// Contacts look for what may come near the current state: after the barrier has changed.
  void look_around() { system_.look_around(); }
  /// The contact barrier's parameters. Setting them asks for look_around or another state.
  struct Contact {
    double stiffness = 0;
    double range = 0;
  };
  Contact contact() const { return {model_.contact()->stiffness(), model_.contact()->range()}; }
  void set_contact(const Contact& contact);
  /// Pairs within the barrier's range; 0 without contact.
  int contacts() const;

  /// The equilibrium before the last one on the same branch, with the tangent there along `travelled` (the change of F
  /// since).
  struct Previous {
    Eigen::Vector4d travelled;
    Eigen::VectorXd x;
    Eigen::VectorXd tangent;  ///< change of x to first order for all of `travelled`
  };
  const std::optional<Previous>& previous() const { return previous_; }
  void set_previous(std::optional<Previous> previous) { previous_ = std::move(previous); }

 private:
  bool raise_contact_stiffness();
  /// K^-1 dg/dF by the last factorization and iterative refinement; false if that is too far from K.
  bool solve_for_strains();
  void condense();
  /// The change of x for a change of the prescribed components of F, to first order.
  Eigen::VectorXd tangent(const Eigen::Vector4d& change) const;
  Eigen::Vector4d prescribed_part(const Eigen::Vector4d& change) const;
  /// The state after a step from x on which parts turn; nothing has looked ahead to it.
  CellState moved(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const;
  /// States that may lie near the equilibrium after `share` of the change.
  std::vector<Eigen::VectorXd> predictions(double share) const;

  CellModel& model_;
  const SimulationOptions& options_;
  const Execution& execution_;
  CellSystem system_;
  CellEquilibrium at_;
  std::optional<Previous> previous_;

  // Of the load step that is under way:
  Eigen::Vector4d change_ = Eigen::Vector4d::Zero();  ///< of F, announced
  Eigen::VectorXd start_, along_;                     ///< where it began, and the tangent there for all of the change
};

/// Stable equilibria of one patch while the macroscopic strain changes.
class CellPath {
 public:
  /// Starts from `x`, which must be valid for the model. All references outlive the path.
  CellPath(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const SimulationOptions& options,
           const Execution& execution);

  using Path = numerics::EquilibriumPath<CellScene>;
  using Progress = Path::Progress;
  using Counts = Path::Counts;

  /// Finds an equilibrium at the present strain.
  bool settle() { return path_.settle(); }
  /// One internal load step towards the prescribed components of `target` (a deformation gradient).
  Progress step_towards(const Eigen::Matrix2d& target) { return path_.step(scene_.announce(target)); }
  /// Adds `mode` (a change of x) to the state, as far as the energy falls, and settles. False where it falls nowhere.
  bool leave_along(const Eigen::VectorXd& mode) { return path_.leave_along(mode); }

  /// Makes the contact barrier's range less and less, until the equilibrium at the same strain no longer changes or
  /// nothing is within it: what is left of the barrier is contact. Where an equilibrium is not found, or only on
  /// another branch, the one of the range before stays.
  void tighten_contact();
  /// Goes back to the equilibrium as it was before, from which the path goes on, since wide barriers are easier to
  /// follow.
  void loosen_contact();

  /// The barrier's parameters at this state.
  CellScene::Contact contact() const { return scene_.contact(); }
  /// Sets them before the path settles for the first time.
  void start_with_contact(const CellScene::Contact& contact) {
    scene_.set_contact(contact);
    scene_.look_around();
  }

  const Eigen::VectorXd& x() const { return scene_.x(); }
  const CellEquilibrium& equilibrium() const { return scene_.at(); }
  bool stable() const { return path_.stable(); }
  /// How the last attempt ended; where it failed the equilibrium is the one before it.
  Stop stopped() const;
  Eigen::Index unknowns() { return scene_.objective().dimension(); }
  Counts take_counts() { return path_.take_counts(); }  ///< since the last call

 private:
  /// As the path was before its contact was tightened.
  struct Loose {
    Path::Snapshot snapshot;
    CellScene::Contact contact;
  };
  Loose loose_now() const { return {path_.snapshot(), scene_.contact()}; }
  void restore(const Loose& loose);
  /// Finds the equilibrium for a barrier of another range; false, and the state is undefined, where there is none.
  bool settle_with_range(double range);

  CellScene scene_;
  Path path_;
  std::optional<Loose> loose_;
};

}  // namespace supple::microscale
