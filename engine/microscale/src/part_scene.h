#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "cell_system.h"
#include "contact_barrier.h"
#include "elastic_energy.h"
#include "part_supports.h"
#include "plate_barrier.h"
#include "rotation_retraction.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/equilibrium_path.h"

namespace supple::microscale {

/// What is known at an equilibrium of a part.
struct PartEquilibrium {
  double energy = 0;         ///< MPa mm^2
  double residual = 0;       ///< |g| / f as in SimulationOptions::tolerance
  Eigen::VectorXd gradient;  ///< with respect to all degrees of freedom, MPa mm
  Eigen::VectorXd tangent;   ///< change of all degrees of freedom for each unit of the supports' fraction, mm
};

/// The scene of a part whose supports move; see numerics::PathScene. Its unknowns are the displacements that no support
/// holds. The macroscopic strain of the coordinates is always zero. The displacements that plates hold change from one
/// equilibrium to the next, and the system is made anew then.
class PartScene {
 public:
  /// What is passed must outlive the scene.
  PartScene(const tiling::PeriodicMesh& mesh, const PartSupports& supports, const PartSimulationOptions& options,
            const Execution& execution);
  ~PartScene() { cholesky_.bill_to(nullptr); }
  PartScene(const PartScene&) = delete;
  PartScene& operator=(const PartScene&) = delete;

  struct State {
    Eigen::VectorXd x;
    double fraction = 0;
    Constraints constraints;
    PartEquilibrium at;
  };
  CellSystem& objective() { return *system_; }
  numerics::ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const { return {x(), fraction_, constraints_, at_}; }
  void set_state(State state);
  double gradient_tolerance() const;
  bool must_minimize_again(const numerics::MinimizerResult& result);
  bool finish(const numerics::MinimizerResult& result);
  bool finish_unstable();
  void begin_step();
  bool predict(double part);
  void finish_load_step(const numerics::LoadStepResult& arrival);
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return system_->expand(y); }
  /// The mode, scaled so that its largest displacement is a beam width.
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const;
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount);
  void left_branch();

  /// The next load steps move the supports to this fraction of their displacements. Returns the change.
  double set_target(double fraction);

  const Eigen::VectorXd& x() const { return system_->state().x; }
  double fraction() const { return fraction_; }
  const Constraints& constraints() const { return constraints_; }
  const PartEquilibrium& at() const { return at_; }
  /// Number of pairs within the contact barrier's range; 0 if contact is off.
  int contacts() const { return contact_ ? contact_->status(x()).pairs : 0; }
  /// Whether the last search ended because the part touched too few supports.
  bool lost_support() const { return lost_support_; }

 private:
  /// Makes the system for the present constraints, at x.
  void make_system(Eigen::VectorXd x);
  CellState cell_state(Eigen::VectorXd x) const { return {std::move(x), retraction_.get()}; }
  void set_fraction(double fraction);
  bool raise_contact_stiffness();
  /// Holds and releases nodes of plates. Returns whether the state has to be minimized again.
  bool correct_constraints();
  /// The derivative of the forces on the unknowns with respect to the fraction, if they do not move, MPa mm.
  Eigen::VectorXd load() const;
  std::vector<Eigen::VectorXd> predictions(double part) const;

  const tiling::PeriodicMesh& mesh_;
  const PartSupports& supports_;
  const PartSimulationOptions& options_;
  const Execution& execution_;
  std::shared_ptr<ElasticEnergy> elastic_;
  std::shared_ptr<ContactBarrier> contact_;  ///< null if contact is off
  std::shared_ptr<PlateBarrier> plates_;
  std::unique_ptr<RotationRetraction> retraction_;
  numerics::ShiftedCholesky cholesky_;
  Constraints constraints_;
  double fraction_ = 0;
  std::unique_ptr<CellSystem> system_;
  PartEquilibrium at_;
  int corrections_ = 0;  ///< number of corrections of the constraints since the last prediction
  bool lost_support_ = false;

  /// The equilibrium before the last one on the same branch.
  struct Previous {
    double change = 0;        ///< change of the fraction since then
    Eigen::VectorXd x;        ///< the state at that equilibrium
    Eigen::VectorXd tangent;  ///< change of x for `change`, to first order
  };
  std::optional<Previous> previous_;

  // The current load step:
  double target_ = 0;
  double start_fraction_ = 0;
  Eigen::VectorXd start_, step_tangent_;  ///< state at its start, and the change of x to first order
};

}  // namespace supple::microscale
