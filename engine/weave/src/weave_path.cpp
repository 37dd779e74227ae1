#include "weave_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::weave {
namespace {

/// A part of a load step below this is not halved again.
constexpr double smallest_part = 1e-4;
/// Fewer iterations than this let the next part grow.
constexpr int quick_iterations = 12;

/// Rounding of a gradient: units in the last place of a coordinate, times a stiffness over a length, in each entry.
constexpr double rounding = 4e-15;

/// Bending is softer than stretching by the square of slenderness: regularizations begin well below both, and steps
/// that leave an unstable state may be lengthened this often.
constexpr double first_regularization = 1e-8;
constexpr double longest_expansion = 64;
/// The way from an unstable equilibrium is long, and shorter load steps would not shorten it.
constexpr int more_iterations_after_leaving = 5;
constexpr int mode_doublings = 12;

/// Relative; equilibria of energies closer than this are mirror images.
constexpr double same_energy = 1e-9;

/// Of the path for the tangent to what is prescribed, by central differences.
constexpr double tangent_step = 1e-6;

numerics::PathOptions path_options(const EquilibriumOptions& equilibrium) {
  numerics::PathOptions options;
  options.minimizer = minimizer_options();
  options.max_iterations = equilibrium.max_iterations;
  options.more_iterations_after_leaving = more_iterations_after_leaving;
  options.smallest_step = smallest_part;
  options.quick_iterations = quick_iterations;
  options.leave_unstable = equilibrium.buckling != Switch::off;
  options.mode_doublings = mode_doublings;
  return options;
}

}  // namespace

numerics::MinimizerOptions minimizer_options() {
  numerics::MinimizerOptions options;
  options.first_regularization = first_regularization;
  options.longest_expansion = longest_expansion;
  return options;
}

double absolute_tolerance(const RodModel& model, double relative) {
  double weakest = std::numeric_limits<double>::infinity();
  double stiffest = 0;
  for (int s = 0; s < static_cast<int>(model.weave().strands.size()); ++s) {
    weakest = std::min(weakest, model.stiffness(s).bend);
    stiffest = std::max(stiffest, model.stiffness(s).stretch);
  }
  double length = 0;
  double shortest = std::numeric_limits<double>::infinity();
  double extent = 0;
  for (const Edge& edge : model.edges()) {
    const double l = edge.to.start - edge.from.start;
    length += l;
    shortest = std::min(shortest, l);
  }
  for (const Eigen::Vector2d& p : model.nodes()) extent = std::max(extent, p.norm());
  length *= model.options().segments / static_cast<double>(model.edges().size());
  const double floor =
      rounding * stiffest / shortest * (1 + extent) * std::sqrt(static_cast<double>(model.edges().size()));
  return std::max(relative * weakest / (length * length), floor);
}

WeaveScene::WeaveScene(WeaveSystem& objective, const EquilibriumOptions& options, CostLedger* cost)
    : objective_(objective),
      leaves_unstable_(options.buckling != Switch::off),
      tolerance_(absolute_tolerance(objective.model(), options.tolerance)) {
  cholesky_.bill_to(cost);
  set_force_share(0);
}

void WeaveScene::set_force_share(double share) {
  force_share_ = share;
  objective_.set_force_share(share);
}

void WeaveScene::set_state(const State& state) {
  set_force_share(state.force_share);
  objective_.set_state(state.q, state.chart);
  factorized_ = false;
}

double WeaveScene::gradient_tolerance() {
  factorized_ = false;  // a minimization begins
  return tolerance_;
}

bool WeaveScene::factorize() {
  factorized_ = cholesky_.factorize(objective_.evaluate(2).hessian, 0);
  return factorized_;
}

bool WeaveScene::finish(const numerics::MinimizerResult&) { return factorize(); }

bool WeaveScene::finish_unstable() {
  factorized_ = false;
  return true;
}

void WeaveScene::begin(const LoadStep& step) {
  step_ = &step;
  done_ = 0;
  share_before_ = force_share_;
}

double WeaveScene::share_after(double share) const {
  return share_before_ + (done_ + share * remaining()) * (step_->force_share - share_before_);
}

void WeaveScene::prescribe(double share, Eigen::VectorXd& q) const {
  q += share * step_->change;
  const RodModel& model = objective_.model();
  if (!model.spatial()) return;
  for (int j = 0; j < model.joints(); ++j) {
    const Eigen::Vector3d turn = share * step_->change.segment<3>(model.joint(j));
    const double angle = turn.norm();
    if (angle > 0) q.segment<3>(model.joint(j)) += (2 * std::tan(angle / 2) / angle - 1) * turn;
  }
}

void WeaveScene::begin_step() {
  start_ = state();
  along_.resize(0);
  // d g / d t along the prescribed path, by central differences: exact enough for a prediction.
  const double more = step_->force_share - force_share_;
  const auto gradient_at = [&](double t) -> Eigen::VectorXd {
    Eigen::VectorXd moved = start_.q;
    prescribe(t, moved);
    objective_.set_force_share(force_share_ + t * more);
    objective_.set_state(std::move(moved), start_.chart);
    return objective_.restrict(objective_.full_gradient());
  };
  const double t = tangent_step / std::max(1.0, step_->change.lpNorm<Eigen::Infinity>());
  const Eigen::VectorXd rate = (gradient_at(t) - gradient_at(-t)) / (2 * t);
  objective_.set_force_share(force_share_);
  objective_.set_state(start_.q, start_.chart);
  if (!factorized_ && !factorize()) return;
  const Eigen::VectorXd y = -cholesky_.solve(rate);
  if (y.allFinite()) along_ = objective_.expand(y);
}

bool WeaveScene::predict(double share) {
  const double part = share * remaining();
  set_force_share(share_after(share));
  double least = std::numeric_limits<double>::infinity();
  std::optional<State> best;
  // The tangent's prediction whole, in part (where it would run past a limit), or not at all.
  for (const double of_tangent : {1.0, 0.5, 0.0}) {
    if (of_tangent > 0 && along_.size() == 0) continue;
    Eigen::VectorXd q = start_.q;
    prescribe(part, q);
    if (of_tangent > 0) q += of_tangent * part * along_;
    objective_.set_state(std::move(q), start_.chart);
    if (!std::isfinite(objective_.evaluate(0).value)) continue;
    const double norm = objective_.evaluate(1).gradient.norm();
    if (!(norm < least)) continue;
    least = norm;
    best = state();
    if (of_tangent == 1.0) break;
  }
  if (!best) return false;
  set_state(*best);
  predicted_ = objective_.q();
  return true;
}

void WeaveScene::arrived(const numerics::Arrival& arrival) {
  done_ = arrival.share == 1 ? 1 : done_ + arrival.share * remaining();
  if (arrival.indefinite) note_ridge();
}

void WeaveScene::note_ridge() {
  const RodModel& model = objective_.model();
  if (ridge_ || !leaves_unstable_ || model.spatial() || !model.weave().lattice || model.sliders().empty()) return;
  ridge_ = predicted_;
}

Eigen::VectorXd WeaveScene::unit_mode(const Eigen::VectorXd& mode) const {
  return mode / std::max(mode.lpNorm<Eigen::Infinity>(), 1e-300);
}

bool WeaveScene::move_along(const State& from, const Eigen::VectorXd& mode, double amount) {
  objective_.set_state(from.q, from.chart);
  if (std::abs(amount) > objective_.largest_step(objective_.restrict(amount < 0 ? Eigen::VectorXd(-mode) : mode)))
    return false;
  objective_.set_state(from.q + amount * mode, from.chart);
  return true;
}

WeavePath::WeavePath(WeaveSystem& objective, const EquilibriumOptions& options, Execution execution)
    : scene_(objective, options, execution.cost),
      execution_(std::move(execution)),
      path_(scene_, path_options(options), execution_) {}

bool WeavePath::advance(const LoadStep& step) {
  using Progress = decltype(path_)::Progress;
  scene_.begin(step);
  path_.set_largest_step(1.0 / std::max(1, step.parts));
  for (Progress progress = Progress::underway; progress == Progress::underway;) {
    reached_ = 1 - scene_.remaining();
    execution_.checkpoint(reached_, "load step");
    progress = path_.step(scene_.remaining());
    if (progress == Progress::failed) return false;
  }
  reached_ = 1;
  return true;
}

bool WeavePath::prefer_lower_from(const WeaveScene::State& state, double energy,
                                  const std::function<double()>& energy_there) {
  return path_.prefer_lower_from(state, same_energy, energy, energy_there);
}

Stop WeavePath::stopped() const {
  switch (path_.stopped()) {
    case numerics::PathStop::converged:
      return Stop::converged;
    case numerics::PathStop::iteration_limit:
      return Stop::iteration_limit;
    case numerics::PathStop::step_too_small:
      break;
  }
  return Stop::step_too_small;
}

}  // namespace supple::weave
