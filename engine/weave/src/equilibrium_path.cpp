#include "equilibrium_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "supple/numerics/least_stable_mode.h"

namespace supple::weave {
namespace {

/// A part of a load step below this is not halved again.
constexpr double smallest_part = 1e-4;
/// Fewer iterations than this let the next part grow, by the factor below.
constexpr int quick_iterations = 12;
constexpr double part_growth = 2;

/// Rounding of a gradient: units in the last place of a coordinate, times a stiffness over a length, in each entry.
constexpr double rounding = 4e-15;

/// Bending is softer than stretching by the square of slenderness: regularizations begin well below both, and steps
/// that leave an unstable state may be lengthened this often.
constexpr double first_regularization = 1e-8;
constexpr double longest_expansion = 64;
/// See MinimizerOptions::saddle_contraction.
constexpr double saddle_contraction = 0.03;
/// The way from an unstable equilibrium is long, and shorter load steps would not shorten it.
constexpr int more_iterations_after_leaving = 5;
constexpr int max_branch_changes = 12;

/// Steps along an unstable mode: largest entry, mm or rad, of the first; each is twice the one before.
constexpr double first_mode_step = 1e-3;
constexpr int mode_doublings = 12;

/// Relative; equilibria of energies closer than this are mirror images.
constexpr double same_energy = 1e-9;

/// Of the path for the tangent to what is prescribed, by central differences.
constexpr double tangent_step = 1e-6;

/// A curvature above minus this share of the mean diagonal entry of the Hessian is rounding.
constexpr double zero_curvature = 1e-13;

}  // namespace

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

EquilibriumPath::EquilibriumPath(WeaveObjective& objective, const EquilibriumOptions& options, Execution execution)
    : objective_(objective),
      options_(options),
      execution_(std::move(execution)),
      tolerance_(absolute_tolerance(objective.model(), options.tolerance)) {
  cholesky_.bill_to(execution_.cost);
  objective_.set_force_share(0);
}

void EquilibriumPath::resume_at(double force_share) {
  force_share_ = force_share;
  objective_.set_force_share(force_share);
}

bool EquilibriumPath::settle() { return minimize(false); }

void EquilibriumPath::prescribe(const Eigen::VectorXd& change, double part, Eigen::VectorXd& q) const {
  q += part * change;
  const RodModel& model = objective_.model();
  if (!model.spatial()) return;
  for (int j = 0; j < model.joints(); ++j) {
    const Eigen::Vector3d turn = part * change.segment<3>(model.joint(j));
    const double angle = turn.norm();
    if (angle > 0) q.segment<3>(model.joint(j)) += (2 * std::tan(angle / 2) / angle - 1) * turn;
  }
}

Eigen::VectorXd EquilibriumPath::response(const LoadStep& step, double share_now) {
  // d g / d t along the prescribed path, by central differences: exact enough for a prediction.
  const Eigen::VectorXd q = objective_.q();
  const Chart chart = objective_.chart();
  const double more = step.force_share - share_now;
  const auto gradient_at = [&](double t) -> Eigen::VectorXd {
    Eigen::VectorXd moved = q;
    prescribe(step.change, t, moved);
    objective_.set_force_share(share_now + t * more);
    objective_.set_state(std::move(moved), chart);
    return objective_.restrict(objective_.full_gradient());
  };
  const double t = tangent_step / std::max(1.0, step.change.lpNorm<Eigen::Infinity>());
  const Eigen::VectorXd rate = (gradient_at(t) - gradient_at(-t)) / (2 * t);
  objective_.set_force_share(share_now);
  objective_.set_state(q, chart);
  if (!factorized_ && !positive_definite()) return {};
  Eigen::VectorXd y = -cholesky_.solve(rate);
  if (!y.allFinite()) return {};
  return objective_.expand(y);
}

bool EquilibriumPath::advance(const LoadStep& step) {
  const double share_before = force_share_;
  double done = 0;
  const double longest = 1.0 / std::max(1, step.parts);
  double part = longest;
  while (done < 1) {
    execution_.checkpoint(done, "load step");
    // A remainder of a rounding error's size would be a part of its own.
    if (part > (1 - done) * (1 - 1e-9)) part = 1 - done;
    const Eigen::VectorXd start = objective_.q();
    const Chart chart = objective_.chart();
    const Eigen::VectorXd along = response(step, force_share_);
    while (true) {
      const int before = iterations_;
      const double share_after = share_before + (done + part) * (step.force_share - share_before);
      objective_.set_force_share(share_after);
      if (try_part(step, part, along)) {
        force_share_ = share_after;
        ++load_steps_;
        done = part == 1 - done ? 1 : done + part;
        if (iterations_ - before <= quick_iterations) part *= part_growth;
        part = std::min(part, longest);
        break;
      }
      objective_.set_force_share(force_share_);
      objective_.set_state(start, chart);
      if (part / 2 < smallest_part) {
        reached_ = done;
        if (stopped_ == Stop::converged) stopped_ = Stop::step_too_small;
        return false;
      }
      part /= 2;
    }
  }
  reached_ = 1;
  return true;
}

bool EquilibriumPath::try_part(const LoadStep& step, double part, const Eigen::VectorXd& along) {
  const Eigen::VectorXd start = objective_.q();
  const Chart chart = objective_.chart();
  double least = std::numeric_limits<double>::infinity();
  std::optional<std::pair<Eigen::VectorXd, Chart>> best;
  // The tangent's prediction whole, in part (where it would run past a limit), or not at all.
  for (const double share : {1.0, 0.5, 0.0}) {
    if (share > 0 && along.size() == 0) continue;
    Eigen::VectorXd q = start;
    prescribe(step.change, part, q);
    if (share > 0) q += share * part * along;
    objective_.set_state(std::move(q), chart);
    if (!std::isfinite(objective_.evaluate(0).value)) continue;
    const double norm = objective_.evaluate(1).gradient.norm();
    if (!(norm < least)) continue;
    least = norm;
    best.emplace(objective_.q(), objective_.chart());
    if (share == 1.0) break;
  }
  if (!best) {
    stopped_ = Stop::step_too_small;
    return false;
  }
  objective_.set_state(std::move(best->first), std::move(best->second));
  Eigen::VectorXd from = objective_.q();
  if (!minimize(false)) return false;
  if (indefinite_) note_ridge(std::move(from));
  return true;
}

void EquilibriumPath::note_ridge(Eigen::VectorXd from) {
  const RodModel& model = objective_.model();
  if (ridge_ || options_.buckling == Switch::off || model.spatial() || !model.weave().lattice ||
      model.sliders().empty())
    return;
  ridge_ = std::move(from);
}

bool EquilibriumPath::prefer_lower_from(Eigen::VectorXd q) {
  const Eigen::VectorXd found = objective_.q();
  const double energy = energy_;
  const double residual = residual_;
  const bool stable = stable_;
  const int branches = branches_left_;
  auto history = history_;
  objective_.set_q(std::move(q));
  const bool lower = minimize(false) && stable_ && energy_ < energy - same_energy * std::abs(energy);
  branches_left_ = branches + (lower ? 1 : 0);
  stopped_ = Stop::converged;
  if (lower) return true;
  objective_.set_q(found);
  energy_ = energy;
  residual_ = residual;
  stable_ = stable;
  history_ = std::move(history);
  factorized_ = false;
  return false;
}

bool EquilibriumPath::minimize(bool left) {
  // The terms and the factorization write their own bills.
  const Execution inner{execution_.cancellation, nullptr, nullptr};
  numerics::MinimizerOptions options;
  options.gradient_tolerance = tolerance_;
  options.first_regularization = first_regularization;
  options.longest_expansion = longest_expansion;
  options.saddle_contraction = options_.buckling != Switch::off ? saddle_contraction : 0;
  factorized_ = false;
  indefinite_ = false;
  while (true) {
    options.max_iterations = options_.max_iterations * (left ? more_iterations_after_leaving : 1);
    numerics::MinimizerResult result = numerics::minimize(objective_, options, inner, &cholesky_);
    iterations_ += result.iterations;
    energy_ = result.value;
    residual_ = result.gradient_norm;
    history_ = std::move(result.history);
    indefinite_ = indefinite_ || result.indefinite;
    if (result.stop == numerics::MinimizerStop::saddle) {
      if (leave_least_stable_mode()) {
        left = true;
      } else {
        options.saddle_contraction = 0;
      }
      continue;
    }
    if (result.stop != numerics::MinimizerStop::converged) {
      stopped_ = result.stop == numerics::MinimizerStop::iteration_limit ? Stop::iteration_limit : Stop::step_too_small;
      return false;
    }
    stopped_ = Stop::converged;
    stable_ = positive_definite();
    if (stable_) return true;
    indefinite_ = true;
    if (!leave_least_stable_mode()) return true;
    left = true;
  }
}

bool EquilibriumPath::positive_definite() {
  factorized_ = cholesky_.factorize(objective_.evaluate(2).hessian, 0);
  return factorized_;
}

bool EquilibriumPath::leave_least_stable_mode() {
  if (options_.buckling == Switch::off || branches_left_ >= max_branch_changes) return false;
  factorized_ = false;
  const numerics::Evaluation evaluation = objective_.evaluate(2);
  const numerics::Mode mode =
      numerics::least_stable_mode(evaluation.hessian, objective_.dimension(), cholesky_, execution_.cancellation);
  stable_ = mode.curvature >= -zero_curvature * numerics::diagonal_scale(evaluation.hessian);
  return !stable_ && move_along(objective_.expand(mode.direction));
}

bool EquilibriumPath::leave_along(const Eigen::VectorXd& mode) { return move_along(mode) && minimize(true); }

bool EquilibriumPath::move_along(const Eigen::VectorXd& mode) {
  const Eigen::VectorXd start = objective_.q();
  const Chart chart = objective_.chart();
  const Eigen::VectorXd unit = mode / std::max(mode.lpNorm<Eigen::Infinity>(), 1e-300);
  const double energy = objective_.evaluate(0).value;
  const double forward = objective_.largest_step(objective_.restrict(unit));
  const double backward = objective_.largest_step(objective_.restrict(-unit));
  const auto energy_at = [&](double amount) {
    if (amount > forward || -amount > backward) return std::numeric_limits<double>::infinity();
    objective_.set_state(start + amount * unit, chart);
    return objective_.evaluate(0).value;
  };
  const auto amount = numerics::lowest_along_mode(energy, first_mode_step, mode_doublings, energy_at);
  objective_.set_state(amount ? start + *amount * unit : start, chart);
  if (!amount) return false;
  ++branches_left_;
  if (execution_.cost)
    execution_.cost->add_effect("buckling", true, "the tangent stiffness was not positive definite", 1);
  return true;
}

}  // namespace supple::weave
