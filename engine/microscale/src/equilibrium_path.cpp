#include "equilibrium_path.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "supple/numerics/least_stable_mode.h"

namespace supple::microscale {
namespace {

/// A load step below this change of F (largest component) is not divided again.
constexpr double smallest_load_step = 1e-6;
/// Fewer Newton iterations than this let the next load step grow, by the factor below.
constexpr int quick_iterations = 6;
constexpr double step_growth = 2;
/// Cubic extrapolation reaches no farther than this many times the step it is made from.
constexpr double longest_extrapolation = 2.5;
/// Two load steps go the same way if the cosine between them is above this.
constexpr double same_direction = 1 - 1e-9;

/// A Newton step that brings the gradient to this share keeps its factorization: a step with the old one costs about a
/// tenth of a new factorization.
constexpr double reuse_contraction = 0.25;

/// Buckling beams curve the energy some 1e8 times less than their elements do, relative to the mean diagonal entry: the
/// search for a regularization begins well below, and steps that leave an unstable state may be lengthened this often.
constexpr double first_regularization = 1e-10;
constexpr double longest_expansion = 64;

/// Iterative refinement of the response to strains: relative residual where it makes the tangent and where it only
/// predicts the next state, and rounds before the factorization is given up.
constexpr double refined = 1e-9;
constexpr double refined_for_prediction = 1e-5;
constexpr int refinement_rounds = 5;

/// While the gradient falls to this share the tangent stiffness may be indefinite; then the search is taken off its way
/// to an unstable equilibrium.
constexpr double saddle_contraction = 0.03;
/// The way from an unstable equilibrium to a stable one is long, and shorter load steps would not shorten it.
constexpr int more_iterations_after_leaving = 4;

/// Steps along an unstable mode: the largest displacement, in beam widths, from the first to the last; each is twice
/// the one before.
constexpr double first_mode_step = 1e-3;
constexpr int mode_doublings = 10;
/// How often one equilibrium may be left for one of lower energy.
constexpr int max_branch_changes = 12;
/// While contact is tightened: the range's factor from one equilibrium to the next, how often, and the relative change
/// of dE/dF below which the range no longer matters.
constexpr double range_factor = 0.25;
constexpr int most_tightenings = 4;
constexpr double unfelt_change = 2e-4;
/// How often one minimization may be repeated, with a contact barrier of twice the stiffness or for a tolerance that
/// turned out too loose.
constexpr int max_repeats = 10;

/// K x for the lower triangle of K; all columns of x at once, so that K is read once.
Eigen::MatrixXd product(const numerics::SparseMatrix& lower, const Eigen::MatrixXd& x) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
  const Rows from = x;
  Rows to = Rows::Zero(x.rows(), 4);
  for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
    const Eigen::RowVector4d own = from.row(column);
    Eigen::RowVector4d sum = Eigen::RowVector4d::Zero();
    for (numerics::SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      sum += entry.value() * from.row(entry.row());
      if (entry.row() != column) to.row(entry.row()) += entry.value() * own;
    }
    to.row(column) += sum;
  }
  return to;
}

}  // namespace

EquilibriumPath::EquilibriumPath(CellModel& model, Eigen::VectorXd x, CellObjective::FreeStrains free,
                                 const SimulationOptions& options, const Execution& execution)
    : model_(model),
      options_(options),
      execution_(execution),
      cholesky_(model.workspace().cholesky),
      objective_(model, std::move(x), std::move(free), execution.cost),
      step_(options.max_load_step) {
  cholesky_.bill_to(execution.cost);
  model_.prepare(objective_.x(), Eigen::VectorXd::Zero(objective_.x().size()), execution_.cost);
}

EquilibriumPath::Counts EquilibriumPath::take_counts() { return std::exchange(counts_, {}); }

bool EquilibriumPath::settle() { return minimize_energy(false); }

EquilibriumPath::Progress EquilibriumPath::step_towards(const Eigen::Matrix2d& target) {
  const Eigen::Vector4d wanted(target(0, 0) - 1, target(0, 1), target(1, 0), target(1, 1) - 1);
  const Eigen::Vector4d change = prescribed_part(wanted - x().tail<4>());
  const double size = change.cwiseAbs().maxCoeff();
  if (size == 0) return Progress::arrived;
  const Eigen::VectorXd start = x();
  const Equilibrium start_equilibrium = at_;
  const Eigen::VectorXd along = tangent(change);
  double share = std::min(1.0, step_ / size);
  // A remainder of a rounding error's size would be a step of its own.
  if (share > 1 - 1e-9) share = 1;
  while (true) {
    execution_.cancellation.throw_if_requested();
    const int before = counts_.iterations;
    const int branches = counts_.branches_left;
    if (try_increment(share, change, along)) {
      ++counts_.load_steps;
      if (counts_.iterations - before <= quick_iterations)
        step_ = std::min(options_.max_load_step, std::max(step_, share * size * step_growth));
      if (counts_.branches_left == branches) {
        previous_ = Previous{share * change, start, share * along};
      } else {
        previous_.reset();
      }
      return share == 1 ? Progress::arrived : Progress::underway;
    }
    objective_.set_x(start);
    at_ = start_equilibrium;
    counts_.branches_left = branches;
    if (share * size / 2 < smallest_load_step) {
      model_.prepare(start, Eigen::VectorXd::Zero(start.size()), execution_.cost);
      stopped_ = stopped_ == Stop::converged ? Stop::step_too_small : stopped_;
      return Progress::failed;
    }
    share /= 2;
    step_ = share * size;
  }
}

Eigen::Vector4d EquilibriumPath::prescribed_part(const Eigen::Vector4d& change) const {
  Eigen::Vector4d part = change;
  for (const Eigen::Vector4d& direction : objective_.free()) part -= direction.dot(change) * direction;
  return part;
}

Eigen::VectorXd EquilibriumPath::tangent(const Eigen::Vector4d& change) const {
  const auto m = static_cast<Eigen::Index>(objective_.free().size());
  Eigen::Vector4d strain = change;
  if (m > 0) {
    Eigen::MatrixXd free(4, m);
    for (Eigen::Index k = 0; k < m; ++k) free.col(k) = objective_.free()[static_cast<std::size_t>(k)];
    const Eigen::MatrixXd stiffness = free.transpose() * at_.condensed * free;
    const Eigen::VectorXd q = stiffness.ldlt().solve(-free.transpose() * at_.condensed * change);
    if (q.allFinite()) strain += free * q;
  }
  Eigen::VectorXd along(x().size());
  along.head(x().size() - 4) = at_.response * strain;
  along.tail<4>() = strain;
  return along;
}

std::vector<Eigen::VectorXd> EquilibriumPath::predictions(double share, const Eigen::Vector4d& change,
                                                          const Eigen::VectorXd& along) const {
  std::vector<Eigen::VectorXd> states;
  if (previous_) {
    const double before = previous_->travelled.norm();
    const double ahead = share * change.norm();
    const double cosine = previous_->travelled.dot(change) / (before * change.norm());
    if (cosine > same_direction && ahead <= longest_extrapolation * before) {
      // Cubic Hermite polynomial through the last two equilibria and their tangents; u = 0 and 1 there.
      const double u = 1 + ahead / before;
      const double h00 = u * u * (2 * u - 3) + 1;
      const double h10 = u * (u - 1) * (u - 1);
      const double h11 = u * u * (u - 1);
      states.emplace_back(h00 * previous_->x + (1 - h00) * x() + h10 * previous_->tangent +
                          h11 * (before / change.norm()) * along);
    }
  }
  states.emplace_back(model_.retract(x(), share * along, execution_.cost));
  return states;
}

bool EquilibriumPath::try_increment(double share, const Eigen::Vector4d& change, const Eigen::VectorXd& along) {
  const Eigen::VectorXd start = x();
  Eigen::Vector4d strain_after = start.tail<4>() + share * change;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(start.size());
  std::optional<Eigen::VectorXd> best;
  double best_norm = std::numeric_limits<double>::infinity();
  for (Eigen::VectorXd& state : predictions(share, change, along)) {
    // The prescribed components exactly; the free ones as predicted.
    const Eigen::Vector4d predicted = state.tail<4>();
    state.tail<4>() = predicted + prescribed_part(strain_after - predicted);
    if (model_.prepare(start, state - start, execution_.cost) < 1) continue;
    objective_.set_x(state);
    const double norm = objective_.evaluate(1).gradient.norm();
    objective_.set_x(start);
    if (norm < best_norm) {
      best_norm = norm;
      best = std::move(state);
    }
  }
  if (!best) return false;
  objective_.set_x(std::move(*best));
  model_.prepare(objective_.x(), none, execution_.cost);
  return minimize_energy(false);
}

bool EquilibriumPath::minimize_energy(bool left) {
  // The terms and the factorization write their own bills.
  const Execution inner{execution_.cancellation, nullptr, nullptr};
  numerics::MinimizerOptions options;
  options.reuse_contraction = reuse_contraction;
  options.first_regularization = first_regularization;
  options.longest_expansion = longest_expansion;
  options.saddle_contraction = options_.buckling != Switch::off ? saddle_contraction : 0;
  for (int repeats = 0;;) {
    options.gradient_tolerance = gradient_tolerance();
    options.max_iterations = options_.max_iterations * (left ? more_iterations_after_leaving : 1);
    const numerics::MinimizerResult result = numerics::minimize(objective_, options, inner, &cholesky_);
    counts_.iterations += result.iterations;
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
    // The forces of the prediction, by which the tolerance was measured, can be larger than those of the equilibrium.
    const bool loose = result.gradient_norm > gradient_tolerance() && result.iterations > 0;
    if (repeats++ < max_repeats && (raise_contact_stiffness() || loose)) continue;
    at_.residual = result.gradient_norm / model_.elastic().force_scale(objective_.x());
    if (finish_equilibrium(result)) return true;
    if (!leave_least_stable_mode()) return finish_unstable_equilibrium();
    left = true;
  }
}

double EquilibriumPath::gradient_tolerance() const {
  const ElasticEnergy& elastic = model_.elastic();
  return std::max(options_.tolerance * elastic.force_scale(objective_.x()), elastic.force_rounding());
}

bool EquilibriumPath::raise_contact_stiffness() {
  ContactBarrier* contact = model_.contact();
  if (!contact || !contact->near()) return false;
  const double suggested = contact->suggested_stiffness(objective_.x());
  if (suggested == contact->stiffness()) return false;
  contact->set_stiffness(suggested);
  objective_.forget();
  previous_.reset();
  return true;
}

EquilibriumPath::Loose EquilibriumPath::snapshot() const {
  return {x(), at_, stopped_, model_.contact()->stiffness(), model_.contact()->range()};
}

void EquilibriumPath::restore(const Loose& loose) {
  model_.contact()->set_stiffness(loose.stiffness);
  model_.contact()->set_range(loose.range);
  objective_.set_x(loose.x);
  at_ = loose.at;
  model_.prepare(x(), Eigen::VectorXd::Zero(x().size()), execution_.cost);
  stopped_ = loose.stopped;
}

bool EquilibriumPath::settle_with_range(double range) {
  model_.contact()->set_range(range);
  objective_.forget();
  model_.prepare(x(), Eigen::VectorXd::Zero(x().size()), execution_.cost);
  const int branches = counts_.branches_left;
  const bool settled = minimize_energy(false) && at_.stable && counts_.branches_left == branches;
  counts_.branches_left = branches;
  return settled;
}

void EquilibriumPath::tighten_contact() {
  const ContactBarrier* contact = model_.contact();
  if (!contact || !at_.stable || contact->status(x()).pairs == 0) return;
  const Loose first = snapshot();
  const auto previous = previous_;
  Loose best = first;
  for (int k = 0; k < most_tightenings && contact->status(best.x).pairs > 0; ++k) {
    const Eigen::Vector4d before = best.at.strain_gradient;
    if (!settle_with_range(best.range * range_factor)) {
      restore(best);
      break;
    }
    // A path that ended at this strain has done so all the same.
    stopped_ = first.stopped;
    best = snapshot();
    if ((at_.strain_gradient - before).norm() <= unfelt_change * at_.strain_gradient.norm()) break;
  }
  previous_ = previous;
  loose_ = first;
}

void EquilibriumPath::loosen_contact() {
  if (loose_) restore(*loose_);
  loose_.reset();
}

bool EquilibriumPath::finish_equilibrium(const numerics::MinimizerResult& result) {
  const numerics::Evaluation evaluation = objective_.evaluate(2);
  at_.energy = objective_.energy();
  at_.strain_gradient = objective_.strain_gradient();
  const bool fresh = result.factorized_at >= 0 && result.history.back().regularization == 0;
  at_.stable = (fresh && solve_for_strains()) || (cholesky_.factorize(evaluation.hessian, 0) && solve_for_strains());
  if (at_.stable) condense();
  return at_.stable;
}

bool EquilibriumPath::finish_unstable_equilibrium() {
  // Also for one at the very point where it loses stability.
  objective_.evaluate(2);
  Eigen::SimplicialLDLT<numerics::SparseMatrix, Eigen::Lower> indefinite(objective_.core());
  at_.response = indefinite.solve(-objective_.strain_columns());
  condense();
  return at_.response.allFinite();
}

bool EquilibriumPath::solve_for_strains() {
  const Eigen::MatrixXd& right = objective_.strain_columns();
  const double wanted = (options_.tangents ? refined : refined_for_prediction) * right.norm();
  at_.response = -cholesky_.solve_core(right);
  for (int round = 0;; ++round) {
    const Eigen::MatrixXd residual = -right - product(objective_.core(), at_.response);
    if (!(residual.norm() > wanted)) return true;
    if (round == refinement_rounds) return residual.norm() < 1e3 * wanted;
    at_.response += cholesky_.solve_core(residual);
  }
}

void EquilibriumPath::condense() {
  const Eigen::Matrix4d product = objective_.strain_columns().transpose() * at_.response;
  at_.condensed = objective_.strain_corner() + 0.5 * (product + product.transpose());
}

bool EquilibriumPath::leave_along(const Eigen::VectorXd& mode) { return move_along(mode) && minimize_energy(true); }

bool EquilibriumPath::leave_least_stable_mode() {
  if (options_.buckling == Switch::off || counts_.branches_left >= max_branch_changes) return false;
  const numerics::Evaluation evaluation = objective_.evaluate(2);
  const numerics::Mode mode =
      numerics::least_stable_mode(evaluation.hessian, objective_.dimension(), cholesky_, execution_.cancellation);
  at_.stable = mode.curvature >= 0;
  return !at_.stable && move_along(objective_.expand(mode.direction));
}

bool EquilibriumPath::move_along(const Eigen::VectorXd& mode) {
  std::optional<Eigen::VectorXd> lower = lowest_along(mode);
  if (!lower) return false;
  ++counts_.branches_left;
  if (execution_.cost)
    execution_.cost->add_effect("buckling", true, "the tangent stiffness was not positive definite", 1);
  previous_.reset();
  objective_.set_x(std::move(*lower));
  model_.prepare(objective_.x(), Eigen::VectorXd::Zero(objective_.x().size()), execution_.cost);
  return true;
}

std::optional<Eigen::VectorXd> EquilibriumPath::lowest_along(const Eigen::VectorXd& mode) {
  const Eigen::VectorXd start = x();
  const double largest = mode.head(mode.size() - 4).cwiseAbs().maxCoeff();
  const Eigen::VectorXd unit = mode * (model_.mesh()->beam_width / std::max(largest, 1e-300));
  const auto state_at = [&](double amount) { return model_.retract(start, amount * unit, execution_.cost); };
  const auto energy_at = [&](double amount) {
    Eigen::VectorXd state = state_at(amount);
    if (model_.prepare(start, state - start, execution_.cost) < 1) return std::numeric_limits<double>::infinity();
    objective_.set_x(std::move(state));
    return objective_.evaluate(0).value;
  };
  const double energy = objective_.evaluate(0).value;
  const auto amount = numerics::lowest_along_mode(energy, first_mode_step, mode_doublings, energy_at);
  objective_.set_x(start);
  return amount ? std::optional(state_at(*amount)) : std::nullopt;
}

}  // namespace supple::microscale
