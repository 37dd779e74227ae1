#pragma once

#include <optional>
#include <vector>

#include "cell_system.h"
#include "supple/base/execution.h"
#include "supple/microscale/simulation.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/equilibrium_path.h"

namespace supple::microscale {

/// Results that are computed at an equilibrium of a patch. Components of F are in the order of CellCoordinates.
struct CellEquilibrium {
  Eigen::Vector4d strain_gradient = Eigen::Vector4d::Zero();  ///< dE / dF, MPa mm^2
  /// d2 E / dF2 of the energy that is minimized over the displacements (a Schur complement), MPa mm^2.
  Eigen::Matrix4d condensed = Eigen::Matrix4d::Zero();
  Eigen::MatrixXd response;  ///< dw / dF of the unknown displacements, one column for each component of F
  double energy = 0;         ///< MPa mm^2
  double residual = 0;       ///< |g| / f as in SimulationOptions::tolerance
};

/// The scene of a patch whose macroscopic strain changes; see numerics::PathScene. The next state is predicted from the
/// tangents of the last two equilibria, by cubic Hermite or linear extrapolation. At each equilibrium the displacements
/// are condensed out.
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
  bool must_minimize_again(const numerics::MinimizerResult& result);
  bool finish(const numerics::MinimizerResult& result);
  bool finish_unstable();
  void begin_step();
  bool predict(double fraction);
  void finish_load_step(const numerics::LoadStepResult& arrival);
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return system_.expand(y); }
  /// The mode, scaled so that its largest displacement is a beam width.
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const;
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount);
  void left_branch();

  /// The next load steps change the prescribed components of F to those of `target`. Returns the largest change of one.
  double set_target(const Eigen::Matrix2d& target);

  const Eigen::VectorXd& x() const { return system_.state().x; }
  const CellEquilibrium& at() const { return at_; }

  /// Prepares the terms for the current state: contacts search their pairs again.
  void prepare_terms() { system_.prepare_terms(); }
  /// The contact barrier's parameters. After they are set, prepare_terms or set_state must be called.
  struct Contact {
    double stiffness = 0;  ///< MPa
    double range = 0;      ///< mm
  };
  Contact contact() const { return {model_.contact()->stiffness(), model_.contact()->range()}; }
  void set_contact(const Contact& contact);
  /// Number of pairs within the barrier's range; 0 if contact is off.
  int contacts() const;

  /// The equilibrium before the last one on the same branch.
  struct Previous {
    Eigen::Vector4d load_change;  ///< change of the prescribed components of F since then
    Eigen::VectorXd x;            ///< the state at that equilibrium
    Eigen::VectorXd tangent;      ///< change of x for `load_change`, to first order
  };
  const std::optional<Previous>& previous() const { return previous_; }
  void set_previous(std::optional<Previous> previous) { previous_ = std::move(previous); }

 private:
  /// Gives the barrier the stiffness that suits the current state. Returns true if it has changed.
  bool raise_contact_stiffness();
  /// Computes the response -K^-1 dg/dF by iterative refinement with the last factorization. Returns false if the
  /// factorized matrix differs too much from K for that.
  bool solve_for_response();
  void condense();
  /// The change of x for a change of the prescribed components of F, to first order.
  Eigen::VectorXd tangent(const Eigen::Vector4d& change) const;
  Eigen::Vector4d prescribed_part(const Eigen::Vector4d& change) const;
  /// The state after a step from x along the model's retraction. The terms are not prepared for it.
  CellState retracted(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const;
  /// Predictions of the equilibrium after the fraction `fraction` of the change of the load.
  std::vector<Eigen::VectorXd> predictions(double fraction) const;

  CellModel& model_;
  const SimulationOptions& options_;
  const Execution& execution_;
  CellSystem system_;
  CellEquilibrium at_;
  std::optional<Previous> previous_;

  // The current load step:
  Eigen::Vector4d change_ = Eigen::Vector4d::Zero();  ///< change of the prescribed components of F that set_target set
  Eigen::VectorXd start_, step_tangent_;              ///< state at its start, and the change of x to first order there
};

/// Follows the stable equilibria of one patch while the macroscopic strain changes.
class CellPath {
 public:
  /// Starts from `x`, at which the energy must be finite. All references must outlive the path.
  CellPath(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const SimulationOptions& options,
           const Execution& execution);

  using Path = numerics::EquilibriumPath<CellScene>;
  using Progress = Path::Progress;
  using Counts = Path::Counts;

  /// Finds an equilibrium at the present strain. Returns false if there is none.
  bool find_equilibrium() { return path_.find_equilibrium(); }
  /// Makes one internal load step to the prescribed components of `target` (a deformation gradient).
  Progress step_towards(const Eigen::Matrix2d& target) { return path_.step(scene_.set_target(target)); }
  /// Adds `mode` (a change of x) to the state as far as the energy falls, and finds the equilibrium there. Returns
  /// false if the energy falls nowhere.
  bool leave_along(const Eigen::VectorXd& mode) { return path_.leave_along(mode); }

  /// Reduces the contact barrier's range in steps, until the equilibrium at the same strain no longer changes or no
  /// pair is within the range. The barrier then acts only where surfaces touch. If no equilibrium is found for a range,
  /// or only one on another branch, the equilibrium for the range before remains.
  void reduce_contact_range();
  /// Restores the equilibrium and the barrier from before reduce_contact_range. The path goes on from there, because
  /// equilibria with wide barriers are easier to follow.
  void restore_contact_range();

  CellScene::Contact contact() const { return scene_.contact(); }
  /// Sets the barrier's parameters, before the first equilibrium is searched.
  void start_with_contact(const CellScene::Contact& contact) {
    scene_.set_contact(contact);
    scene_.prepare_terms();
  }

  const Eigen::VectorXd& x() const { return scene_.x(); }
  const CellEquilibrium& equilibrium() const { return scene_.at(); }
  bool stable() const { return path_.stable(); }
  /// How the last step or search ended. If it failed, the current equilibrium is the one before it.
  Stop stopped() const;
  Eigen::Index unknowns() { return scene_.objective().dimension(); }
  /// The counts since the last call.
  Counts take_counts() { return path_.take_counts(); }

 private:
  struct SavedState {
    Path::Snapshot snapshot;
    CellScene::Contact contact;
  };
  SavedState save() const { return {path_.snapshot(), scene_.contact()}; }
  void restore(const SavedState& saved);
  /// Finds the equilibrium for another range of the barrier. Returns false if there is none on the same branch; the
  /// state is then undefined.
  bool find_equilibrium_with_range(double range);

  CellScene scene_;
  Path path_;
  std::optional<SavedState> before_reduction_;  ///< what restore_contact_range restores
};

}  // namespace supple::microscale
