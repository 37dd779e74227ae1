#include "weave_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::weave {
namespace {

/// Maximum strain of one load increment, if the options leave the number of increments open.
constexpr double max_strain_step = 0.04;
/// Maximum number of increments in that case.
constexpr double max_strain_steps = 1000;

/// Number of load increments across a bifurcation to its other side.
constexpr int increments_across = 4;
/// Fraction of that path beyond which the bifurcation has been passed.
constexpr double min_fraction_across = 0.6;

/// Maximum number of times that barriers are narrowed, if the equilibrium with rigid limits is too far from that with
/// barriers.
constexpr int max_narrowings = 3;
/// Factor of the barriers' range for each narrowing.
constexpr double narrowing_factor = 0.25;
/// Maximum number of times that a whole path is followed again with narrower barriers.
constexpr int max_narrower_paths = 2;

}  // namespace

WeaveRun::WeaveRun(const Weave& weave, const Prescription& prescription, double direction,
                   const EquilibriumOptions& options, const Execution& execution)
    : weave_(weave), prescription_(prescription), options_(options), execution_(execution) {
  if (options.barrier_range) energy_.barrier_range = *options.barrier_range;
  energy_.least_distance = options.least_distance;
  if (options.sliding_regularization) energy_.sliding_regularization = *options.sliding_regularization;
  model_options_.segments = options.segments;
  model_options_.max_segment_turn = options.max_segment_turn;
  model_options_.direction = direction;
  model_options_.cancellation = execution.cancellation;
  rigid_cholesky_.use_fast_ordering();
  rigid_cholesky_.stop_with(execution.cancellation);
  rigid_cholesky_.bill_to(execution.cost);
  start(options.out_of_plane == Switch::on || (options.out_of_plane == Switch::automatic && prescription.leaves_plane));
}

std::vector<bool> WeaveRun::fixed_of(const RodModel& model) const {
  std::vector<bool> fixed = gauge_constraints(model);
  for (const Prescription::Entry& entry : prescription_.fixed) {
    int dof = -1;
    switch (entry.kind) {
      case Prescription::Entry::Kind::position:
        if (entry.component < model.dimension())
          dof = model.position(model.anchor_node(static_cast<std::size_t>(entry.index))) + entry.component;
        break;
      case Prescription::Entry::Kind::joint: {
        const int joint = model.anchor_joint(static_cast<std::size_t>(entry.index));
        if (model.spatial()) {
          dof = model.joint(joint) + entry.component;
        } else if (entry.component == 2) {
          dof = model.joint(joint);
        }
        break;
      }
      case Prescription::Entry::Kind::strain:
        dof = model.strain() + entry.index;
        break;
    }
    if (dof >= 0) fixed[static_cast<std::size_t>(dof)] = true;
  }
  return fixed;
}

LoadStep WeaveRun::step_to(double fraction) const {
  const RodModel& model = *model_;
  LoadStep step{Eigen::VectorXd::Zero(model.size()), fraction};
  const double increment = fraction - fraction_;
  // The small offset keeps rounding from adding one more increment.
  const double strain_steps = std::ceil(increment * prescription_.strain / max_strain_step - 1e-9);
  step.min_increments =
      options_.load_steps > 0 ? options_.load_steps : static_cast<int>(std::clamp(strain_steps, 1.0, max_strain_steps));
  for (const Prescription::Entry& entry : prescription_.fixed) {
    switch (entry.kind) {
      case Prescription::Entry::Kind::position:
        if (entry.component < model.dimension())
          step.change[model.position(model.anchor_node(static_cast<std::size_t>(entry.index))) + entry.component] +=
              increment * entry.change;
        break;
      case Prescription::Entry::Kind::joint: {
        const int joint = model.joint(model.anchor_joint(static_cast<std::size_t>(entry.index)));
        if (model.spatial()) {
          step.change[joint + entry.component] += increment * entry.change;
        } else if (entry.component == 2) {
          step.change[joint] += increment * entry.change;
        }
        break;
      }
      case Prescription::Entry::Kind::strain:
        step.change[model.strain() + entry.index] += increment * entry.change;
        break;
    }
  }
  return step;
}

std::vector<PointForces::Load> WeaveRun::point_forces() const {
  std::vector<PointForces::Load> loads;
  for (const Prescription::Force& force : prescription_.forces)
    for (int c = 0; c < model_->dimension(); ++c)
      if (force.force[c] != 0)
        loads.push_back(
            {model_->position(model_->anchor_node(static_cast<std::size_t>(force.anchor))) + c, force.force[c]});
  return loads;
}

void WeaveRun::start(bool spatial) {
  model_options_.spatial = spatial;
  model_ = std::make_unique<RodModel>(weave_, prescription_.anchors, model_options_);
  Eigen::VectorXd q = model_->rest_state();
  Chart chart = spatial ? flat_chart(*model_, q) : Chart{};
  reported_.reset();
  objective_ = std::make_unique<WeaveSystem>(*model_, std::move(q), std::move(chart), fixed_of(*model_), energy_,
                                             point_forces(), execution_);
  path_ = std::make_unique<WeavePath>(*objective_, options_, execution_);
}

const LimitedState& WeaveRun::reported() {
  if (reported_) return *reported_;
  reported_ = with_barriers(*objective_, path_->residual(), path_->stable());
  if (reported_->limit_error == 0 || options_.limit_tolerance >= 1 || path_->termination() != Stop::converged)
    return *reported_;
  const auto with_limits_of = [this](const WeaveSystem& barriers, LimitedState start) {
    WeaveSystem rigid = barriers.with_rigid_limits();
    LimitedState found =
        with_rigid_limits(std::move(start), rigid, rigid_cholesky_, options_, path_->tolerance(), execution_);
    iterations_ += found.iterations;
    return found;
  };
  reported_ = with_limits_of(*objective_, std::move(*reported_));
  // If the limits are too far from the equilibrium with barriers, narrower barriers lead to states closer to them.
  EnergyOptions narrower = energy_;
  std::unique_ptr<WeaveSystem> last;
  for (int k = 0; k < max_narrowings && reported_->limit_error > options_.limit_tolerance; ++k) {
    narrower.barrier_range *= narrowing_factor;
    const WeaveSystem& from = last ? *last : *objective_;
    auto next = std::make_unique<WeaveSystem>(*model_, from.q(), from.chart(), fixed_of(*model_), narrower,
                                              point_forces(), execution_);
    WeavePath path(*next, options_, execution_);
    path.resume_at(path_->force_fraction());
    const bool converged = path.find_equilibrium();
    iterations_ += path.iterations();
    if (!converged) break;
    reported_ = with_limits_of(*next, with_barriers(*next, path.residual(), path.stable()));
    last = std::move(next);
  }
  return *reported_;
}

CellConfiguration WeaveRun::configuration() const {
  return {spatial(), objective_->q(), objective_->chart(), model_->deformation_gradient(objective_->q())};
}

bool WeaveRun::continue_from(const CellConfiguration& from) {
  start(from.spatial);
  Eigen::VectorXd q = from.q;
  for (int k = 0; k < 4; ++k)
    q[model_->strain() + k] =
        model_->dyads()[static_cast<std::size_t>(k)].cwiseProduct(from.deformation_gradient).sum();
  LoadStep step{Eigen::VectorXd::Zero(model_->size()), 1};
  const Eigen::VectorXd rest = model_->rest_state();
  for (const Prescription::Entry& entry : prescription_.fixed) {
    const int dof = model_->strain() + entry.index;
    step.change[dof] = rest[dof] + entry.change - q[dof];
  }
  const double change = step.change.lpNorm<Eigen::Infinity>();
  step.min_increments = std::max(1, static_cast<int>(std::ceil(change / max_strain_step - 1e-9)));
  objective_->set_state(std::move(q), from.chart);
  path_->resume_at(1);
  const bool arrived = path_->advance(step);
  fraction_ = arrived ? 1 : 0;
  return arrived && leave_plane_if_unstable();
}

bool WeaveRun::advance_to(double fraction) {
  const double fraction_before = fraction_;
  reported_.reset();
  const bool arrived = path_->advance(step_to(fraction));
  if (arrived) {
    try_other_branch();
    try_path_without_branching();
  }
  fraction_ = arrived ? fraction : fraction_before + path_->reached() * (fraction - fraction_before);
  return leave_plane_if_unstable() && arrived;
}

void WeaveRun::try_other_branch() {
  const auto bifurcation = path_->take_bifurcation();
  if (!bifurcation) return;
  // The sliders are moved over the bifurcation, as far to its other side as they are on this one.
  const Eigen::VectorXd& found = objective_->q();
  LoadStep across{Eigen::VectorXd::Zero(model_->size()), 1, increments_across};
  std::vector<bool> fixed = fixed_of(*model_);
  for (int i = 0; i < static_cast<int>(model_->sliders().size()); ++i) {
    const int dof = model_->slider(i);
    fixed[static_cast<std::size_t>(dof)] = true;
    across.change[dof] = 2 * ((*bifurcation)[dof] - found[dof]);
  }
  WeaveSystem constrained(*model_, found, objective_->chart(), fixed, energy_, {}, execution_);
  WeavePath other_side(constrained, options_, execution_);
  other_side.advance(across);
  iterations_ += other_side.iterations();
  const bool lower =
      other_side.reached() > min_fraction_across && prefer_lower_from({constrained.q(), constrained.chart(), 1});
  compared_branches_ = true;
  if (execution_.cost)
    execution_.cost->add_effect("buckling", true, "the tangent stiffness was not positive definite", lower ? 1 : 0);
}

void WeaveRun::try_path_without_branching() {
  if (!weave_.lattice || options_.buckling == Switch::off || path_->branches_left() == 0) return;
  EquilibriumOptions options = options_;
  options.buckling = Switch::off;
  options.out_of_plane = spatial() ? Switch::on : Switch::off;
  WeaveRun straight(weave_, prescription_, model_options_.direction, options,
                    {execution_.cancellation, nullptr, execution_.cost});
  const bool arrived = straight.advance_to(1);
  iterations_ += straight.iterations();
  if (arrived) prefer_lower_from(straight.path_->state());
  compared_branches_ = true;
}

bool WeaveRun::prefer_lower_from(const WeaveScene::State& state) {
  LimitedState found = reported();
  const auto energy = [this] {
    reported_.reset();
    return reported().energy;
  };
  const bool lower = path_->prefer_lower_from(state, found.energy, energy);
  if (!lower) reported_ = std::move(found);
  return lower;
}

bool WeaveRun::leave_plane_if_unstable() {
  if (spatial() || options_.out_of_plane != Switch::automatic || path_->termination() != Stop::converged) return true;
  ModelOptions spatial_options = model_options_;
  spatial_options.spatial = true;
  auto spatial = std::make_unique<RodModel>(weave_, prescription_.anchors, spatial_options);
  SpatialState state = lift(*model_, objective_->q(), *spatial);
  const std::vector<bool> fixed = fixed_of(*spatial);
  const auto mode = out_of_plane_mode(*spatial, state, fixed, energy_, execution_);
  if (!mode) return true;
  buckled_out_of_plane_ = true;
  iterations_ = iterations();
  load_steps_ = load_steps();
  branches_ = branches();
  path_.reset();
  objective_.reset();
  start(true);
  objective_->set_state(std::move(state.q), std::move(state.chart));
  path_->resume_at(fraction_);
  return path_->leave_along(*mode) || path_->find_equilibrium();
}

void WeaveRun::bill_effects() const {
  CostLedger* cost = execution_.cost;
  if (!cost) return;
  const bool asked = options_.out_of_plane == Switch::on;
  cost->add_effect("out_of_plane", spatial(),
                   options_.out_of_plane == Switch::off ? "switched off by the request"
                   : asked                              ? "switched on by the request"
                   : prescription_.leaves_plane         ? "something is held or loaded out of the plane"
                   : buckled_out_of_plane_ ? "a planar equilibrium was unstable against a mode out of its plane"
                                           : "planar equilibria were stable against all modes out of the plane");
  if (!spatial()) cost->add_effect("twist", false, "strands in the plane do not twist");
  if (model_->joints() == 0) cost->add_effect("joint_bend", false, "no crossing is fused");
  if (model_->sliders().empty()) {
    cost->add_effect("sliding_regularizer", false, "nothing slides");
  } else {
    const Eigen::VectorXd& q = reported_ ? reported_->q : objective_->q();
    const int limits = objective_->limits()->count_within_range(q);
    const int near = objective_->contact()->count_within_range(q);
    cost->add_effect("at_sliding_limits", limits > 0,
                     limits > 0 ? "sliders came within the barrier's range of their limits"
                                : "no slider came within the barrier's range of its limits",
                     limits);
    cost->add_effect("crossings_in_contact", near > 0,
                     near > 0 ? "neighbouring crossings came within the barrier's range"
                              : "no neighbouring crossings came within the barrier's range",
                     near);
  }
  if (branches() == 0 && !compared_branches_)
    cost->add_effect("buckling", false,
                     options_.buckling == Switch::off ? "switched off by the request"
                                                      : "the tangent stiffness stayed positive definite");
}

CellPath follow_cell(const Weave& weave, const Prescription& prescription, double direction, EquilibriumOptions options,
                     const Execution& execution) {
  CellPath path;
  const auto follow = [&] {
    CellPath followed{std::make_unique<WeaveRun>(weave, prescription, direction, options, execution), false};
    followed.arrived = followed.run->advance_to(1);
    return followed;
  };
  path = follow();
  for (int k = 0; k < max_narrower_paths && path.arrived && path.run->reported().limit_error > options.limit_tolerance;
       ++k) {
    options.barrier_range = narrowing_factor * options.barrier_range.value_or(EnergyOptions{}.barrier_range);
    CellPath narrower = follow();
    const bool better = narrower.arrived && narrower.run->reported().limit_error < path.run->reported().limit_error;
    if (better) std::swap(path, narrower);
    path.run->count_iterations(narrower.run->iterations());
  }
  return path;
}

std::vector<std::vector<Eigen::Vector3d>> polylines(const RodModel& model, const Eigen::VectorXd& q, double unit) {
  std::vector<std::vector<Eigen::Vector3d>> lines(model.weave().strands.size());
  for (const Edge& edge : model.edges()) {
    auto& line = lines[static_cast<std::size_t>(edge.strand)];
    if (line.empty()) {
      Eigen::Vector3d first = Eigen::Vector3d::Zero();
      first.head(model.dimension()) = unit * q.segment(model.position(edge.tail), model.dimension());
      line.push_back(first);
    }
    const Eigen::Vector3d next = line.back() + unit * model.edge_vector(edge, q);
    line.push_back(next);
  }
  return lines;
}

}  // namespace supple::weave
