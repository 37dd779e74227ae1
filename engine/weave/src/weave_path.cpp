#include "weave_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple::weave {
namespace {

/// Minimum load increment, as a fraction of the load step. A shorter one is not halved again.
constexpr double min_increment = 1e-4;
/// If an increment took no more iterations than this, the next one may be longer.
constexpr int quick_iterations = 12;

/// Relative rounding error of a gradient: a few units in the last place of a coordinate. In each entry it is multiplied
/// by a stretching stiffness over a length.
constexpr double gradient_rounding = 4e-15;

/// First regularization of a Hessian. Bending is softer than stretching by the square of the slenderness, and the
/// regularization begins well below both.
constexpr double first_regularization = 1e-8;
/// Maximum factor by which a step that leaves an unstable state is lengthened.
constexpr double max_expansion = 64;
/// Factor of the iterations allowed after an unstable equilibrium was left. The path to a stable one is long, and
/// shorter load increments would not shorten it.
constexpr int iteration_factor_after_leaving = 5;
/// Number of doublings of the step along an unstable mode.
constexpr int mode_doublings = 12;

/// Relative difference of energies below which equilibria are mirror images of each other.
constexpr double same_energy_tolerance = 1e-9;

/// Finite-difference step of the load tangent.
constexpr double tangent_step = 1e-6;

numerics::PathOptions path_options(const EquilibriumOptions& equilibrium) {
  numerics::PathOptions options;
  options.minimizer = minimizer_options();
  options.max_iterations = equilibrium.max_iterations;
  options.iteration_factor_after_leaving = iteration_factor_after_leaving;
  options.smallest_step = min_increment;
  options.quick_iterations = quick_iterations;
  options.leave_unstable = equilibrium.buckling != Switch::off;
  options.mode_doublings = mode_doublings;
  return options;
}

}  // namespace

numerics::MinimizerOptions minimizer_options() {
  numerics::MinimizerOptions options;
  options.first_regularization = first_regularization;
  options.max_expansion = max_expansion;
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
  const double rounding_floor =
      gradient_rounding * stiffest / shortest * (1 + extent) * std::sqrt(static_cast<double>(model.edges().size()));
  return std::max(relative * weakest / (length * length), rounding_floor);
}

WeaveScene::WeaveScene(WeaveSystem& objective, const EquilibriumOptions& options, CostLedger* cost)
    : objective_(objective),
      leaves_unstable_(options.buckling != Switch::off),
      tolerance_(absolute_tolerance(objective.model(), options.tolerance)) {
  cholesky_.bill_to(cost);
  set_force_fraction(0);
}

void WeaveScene::set_force_fraction(double fraction) {
  force_fraction_ = fraction;
  objective_.set_force_fraction(fraction);
}

void WeaveScene::set_state(const State& state) {
  set_force_fraction(state.force_fraction);
  objective_.set_state(state.q, state.chart);
  factorized_ = false;
}

double WeaveScene::gradient_tolerance() {
  factorized_ = false;  // the minimization that follows replaces the factors
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
  completed_ = 0;
  force_fraction_before_ = force_fraction_;
}

double WeaveScene::force_fraction_after(double fraction) const {
  return force_fraction_before_ +
         (completed_ + fraction * remaining()) * (step_->force_fraction - force_fraction_before_);
}

void WeaveScene::prescribe(double fraction, Eigen::VectorXd& q) const {
  q += fraction * step_->change;
  const RodModel& model = objective_.model();
  if (!model.spatial()) return;
  for (int j = 0; j < model.joints(); ++j) {
    const Eigen::Vector3d turn = fraction * step_->change.segment<3>(model.joint(j));
    const double angle = turn.norm();
    if (angle > 0) q.segment<3>(model.joint(j)) += (2 * std::tan(angle / 2) / angle - 1) * turn;
  }
}

void WeaveScene::begin_step() {
  start_ = state();
  tangent_.resize(0);
  // Derivative of the gradient by the load, by central differences: a prediction needs no more accuracy.
  const double force_change = step_->force_fraction - force_fraction_;
  const auto gradient_at = [&](double t) -> Eigen::VectorXd {
    Eigen::VectorXd moved = start_.q;
    prescribe(t, moved);
    objective_.set_force_fraction(force_fraction_ + t * force_change);
    objective_.set_state(std::move(moved), start_.chart);
    return objective_.restrict(objective_.full_gradient());
  };
  const double t = tangent_step / std::max(1.0, step_->change.lpNorm<Eigen::Infinity>());
  const Eigen::VectorXd rate = (gradient_at(t) - gradient_at(-t)) / (2 * t);
  objective_.set_force_fraction(force_fraction_);
  objective_.set_state(start_.q, start_.chart);
  if (!factorized_ && !factorize()) return;
  const Eigen::VectorXd y = -cholesky_.solve(rate);
  if (y.allFinite()) tangent_ = objective_.expand(y);
}

bool WeaveScene::predict(double fraction) {
  const double increment = fraction * remaining();
  set_force_fraction(force_fraction_after(fraction));
  double min_norm = std::numeric_limits<double>::infinity();
  std::optional<State> best;
  // Tries the whole tangent step, half of it (if the whole one would cross a limit), and none of it.
  for (const double tangent_fraction : {1.0, 0.5, 0.0}) {
    if (tangent_fraction > 0 && tangent_.size() == 0) continue;
    Eigen::VectorXd q = start_.q;
    prescribe(increment, q);
    if (tangent_fraction > 0) q += tangent_fraction * increment * tangent_;
    objective_.set_state(std::move(q), start_.chart);
    if (!std::isfinite(objective_.evaluate(0).value)) continue;
    const double norm = objective_.evaluate(1).gradient.norm();
    if (!(norm < min_norm)) continue;
    min_norm = norm;
    best = state();
    if (tangent_fraction == 1.0) break;
  }
  if (!best) return false;
  set_state(*best);
  predicted_ = objective_.q();
  return true;
}

void WeaveScene::finish_load_step(const numerics::LoadStepResult& arrival) {
  completed_ = arrival.fraction == 1 ? 1 : completed_ + arrival.fraction * remaining();
  if (arrival.indefinite) remember_bifurcation();
}

void WeaveScene::remember_bifurcation() {
  const RodModel& model = objective_.model();
  if (bifurcation_ || !leaves_unstable_ || model.spatial() || !model.weave().lattice || model.sliders().empty()) return;
  bifurcation_ = predicted_;
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
  path_.set_largest_step(1.0 / std::max(1, step.min_increments));
  for (Progress progress = Progress::partial; progress == Progress::partial;) {
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
  return path_.prefer_lower_from(state, same_energy_tolerance, energy, energy_there);
}

Stop WeavePath::termination() const {
  switch (path_.stopped()) {
    case numerics::PathTermination::converged:
      return Stop::converged;
    case numerics::PathTermination::iteration_limit:
      return Stop::iteration_limit;
    case numerics::PathTermination::step_too_small:
      break;
  }
  return Stop::step_too_small;
}

}  // namespace supple::weave
