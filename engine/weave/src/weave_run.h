#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "limited_state.h"
#include "out_of_plane.h"
#include "supple/base/execution.h"
#include "supple/weave/equilibrium.h"
#include "weave_path.h"

namespace supple::weave {

/// The prescribed values and forces of a weave, planar or spatial.
struct Prescription {
  /// A fixed degree of freedom and its change over the whole path.
  struct Entry {
    enum class Kind { position, joint, strain } kind = Kind::position;
    int index = 0;      ///< anchor (position, joint) or strain component
    int component = 0;  ///< 0, 1, 2 for x, y, z; of a joint's rotation 2 is about z
    double change = 0;  ///< mm, rad or 1
  };
  std::vector<Anchor> anchors;
  std::vector<Entry> fixed;
  struct Force {
    int anchor = 0;
    Eigen::Vector3d force{0, 0, 0};  ///< N
  };
  std::vector<Force> forces;
  bool leaves_plane = false;  ///< whether a support moves or a force acts out of the plane
  double strain = 0;          ///< over the whole path, as it is measured for EquilibriumOptions::load_steps
};

/// A state of a cell, independent of the direction along which the cell is strained.
struct CellConfiguration {
  bool spatial = false;
  Eigen::VectorXd q;
  Chart chart;
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
};

/// A weave that follows one load path: in the plane first, and in space from the state where that becomes necessary.
class WeaveRun {
 public:
  /// All arguments except `options` must outlive the run. `weave` and all other quantities are in natural units.
  WeaveRun(const Weave& weave, const Prescription& prescription, double direction, const EquilibriumOptions& options,
           const Execution& execution);

  /// Follows the path to this fraction (0, 1] of the whole. Returns false if that is not possible; the state is then
  /// the last equilibrium.
  bool advance_to(double fraction);

  /// The current equilibrium with its sliders at their limits.
  const LimitedState& reported();

  /// The current state of a cell, with barriers before the limits.
  CellConfiguration configuration() const;
  /// Follows a path from an equilibrium of the same cell under another strain to the whole of the prescribed strain.
  /// Discards the results of a path from rest. Returns false if the end was not reached.
  bool continue_from(const CellConfiguration& from);

  const RodModel& model() const { return *model_; }
  const WeaveSystem& objective() const { return *objective_; }
  const WeavePath& path() const { return *path_; }
  bool spatial() const { return model_->spatial(); }
  int iterations() const { return iterations_ + path_->iterations(); }
  /// Adds iterations that another run needed for the same answer.
  void count_iterations(int more) { iterations_ += more; }
  int load_steps() const { return load_steps_ + path_->load_steps(); }
  int branches() const { return branches_ + path_->branches_left(); }
  double fraction() const { return fraction_; }

  /// Writes to the bill which effects ran, which did not, and why.
  void bill_effects() const;

 private:
  std::vector<bool> fixed_of(const RodModel& model) const;
  LoadStep step_to(double fraction) const;
  std::vector<PointForces::Load> point_forces() const;
  void start(bool spatial);
  /// If the path passed a bifurcation, computes the equilibrium on its other branch, and changes to it if its energy is
  /// lower.
  void try_other_branch();
  /// If the path left an unstable equilibrium of a cell, also follows the path that leaves none, and changes to its end
  /// if the energy there is lower.
  void try_path_without_branching();
  /// Changes to the equilibrium near `state` if its energy with rigid limits is lower. Returns whether it did.
  bool prefer_lower_from(const WeaveScene::State& state);
  /// If the planar equilibrium is unstable out of its plane, continues in space. Returns false if the search there
  /// failed.
  bool leave_plane_if_unstable();

  const Weave& weave_;
  const Prescription& prescription_;
  EquilibriumOptions options_;
  Execution execution_;
  EnergyOptions energy_;
  ModelOptions model_options_;
  std::unique_ptr<RodModel> model_;
  std::unique_ptr<WeaveSystem> objective_;
  std::unique_ptr<WeavePath> path_;
  double fraction_ = 0;
  int iterations_ = 0;
  int load_steps_ = 0;
  int branches_ = 0;
  bool buckled_out_of_plane_ = false;
  bool compared_branches_ = false;  ///< whether another branch or path was computed for comparison
  std::optional<LimitedState> reported_;
  numerics::ShiftedCholesky rigid_cholesky_;
};

struct CellPath {
  std::unique_ptr<WeaveRun> run;
  bool arrived = false;
};
/// Follows the whole path of a cell from rest. If no equilibrium with sliders at their limits is found near its end,
/// the path is followed again with narrower barriers.
CellPath follow_cell(const Weave& weave, const Prescription& prescription, double direction, EquilibriumOptions options,
                     const Execution& execution);

/// Deformed polylines of all strands in mm, where the model's unit is `unit` mm. Closed strands have their first point
/// at the end again. Each strand is in the cell of its first node.
std::vector<std::vector<Eigen::Vector3d>> polylines(const RodModel& model, const Eigen::VectorXd& q, double unit);

}  // namespace supple::weave
