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

/// What is prescribed of a weave, planar or spatial alike.
struct Prescription {
  struct Entry {
    enum class Kind { position, joint, strain } kind = Kind::position;
    int index = 0;      ///< anchor (position, joint) or strain component
    int component = 0;  ///< 0, 1, 2; of a joint's rotation 2 is about z
    double change = 0;  ///< mm, rad or 1; over the whole path
  };
  std::vector<Anchor> anchors;
  std::vector<Entry> held;
  struct Force {
    int anchor = 0;
    Eigen::Vector3d force{0, 0, 0};  ///< N
  };
  std::vector<Force> forces;
  bool leaves_plane = false;  ///< something is held away from it or pushed out of it
  double strain = 0;          ///< over the whole path, as EquilibriumOptions::load_steps measures it
};

/// A state of a cell, whatever the direction along which it is strained.
struct CellConfiguration {
  bool spatial = false;
  Eigen::VectorXd q;
  Chart chart;
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
};

/// A weave on its way along one load path: in the plane first, in space from where that is called for.
class WeaveRun {
 public:
  /// All arguments but `options` outlive the run. `weave` and all else are in natural units.
  WeaveRun(const Weave& weave, const Prescription& prescription, double direction, const EquilibriumOptions& options,
           const Execution& execution);

  /// Follows the path to this share (0, 1] of the whole. False where it could not; the state is the last equilibrium.
  bool advance_to(double share);

  /// The present equilibrium with its sliders at their limits.
  const LimitedState& reported();

  /// The present state of a cell, with barriers.
  CellConfiguration configuration() const;
  /// Goes from an equilibrium of the same cell that is strained otherwise to the whole of what is prescribed here.
  /// False where it could not. What a path from rest led to is forgotten.
  bool go_on_from(const CellConfiguration& from);

  const RodModel& model() const { return *model_; }
  const WeaveSystem& objective() const { return *objective_; }
  const WeavePath& path() const { return *path_; }
  bool spatial() const { return model_->spatial(); }
  int iterations() const { return iterations_ + path_->iterations(); }
  /// Iterations that another run took for the same answer count too.
  void count_iterations(int more) { iterations_ += more; }
  int load_steps() const { return load_steps_ + path_->load_steps(); }
  int branches() const { return branches_ + path_->branches_left(); }
  double share() const { return share_; }

  /// The effects that ran and those that did not, and why, for the bill.
  void bill_effects() const;

 private:
  std::vector<bool> held_of(const RodModel& model) const;
  LoadStep step_to(double share) const;
  std::vector<PointForces::Load> point_forces() const;
  void start(bool spatial);
  /// Looks at the other side of a ridge on the way and goes over to it where the energy is lower.
  void prefer_lower_side();
  /// If an unstable equilibrium of a cell was left on the way, looks at the path that leaves none, and goes over to
  /// where it ends if the energy is lower.
  void prefer_straight_path();
  bool prefer_lower_from(const WeaveScene::State& state);
  /// Where the planar equilibrium is unstable out of its plane, goes on in space. False where that search failed.
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
  double share_ = 0;
  int iterations_ = 0;
  int load_steps_ = 0;
  int branches_ = 0;
  bool buckled_out_ = false;
  bool looked_across_ = false;  ///< at the other side of a ridge, or at the path that leaves no branch
  std::optional<LimitedState> reported_;
  numerics::ShiftedCholesky rigid_cholesky_;
};

struct CellPath {
  std::unique_ptr<WeaveRun> run;
  bool arrived = false;
};
/// Follows the whole path of a cell from rest. If no equilibrium with sliders at their limits is found near where it
/// ends, the path is followed again with narrower barriers.
CellPath follow_cell(const Weave& weave, const Prescription& prescription, double direction, EquilibriumOptions options,
                     const Execution& execution);

/// Deformed polylines of all strands, closed ones with their first point at the end again, in the cell of the first
/// node of each; mm, where `unit` is the length of the model's unit in mm.
std::vector<std::vector<Eigen::Vector3d>> polylines(const RodModel& model, const Eigen::VectorXd& q, double unit);

}  // namespace supple::weave
