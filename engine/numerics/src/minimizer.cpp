#include "supple/numerics/minimizer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "descent_direction.h"
#include "supple/base/error.h"

namespace supple::numerics {
namespace {

/// The regularization counts as reduced below this factor of the one before. It is not 1, because the scale of the
/// Hessian varies a little.
constexpr double reduced_regularization = 0.5;

/// Fraction of a creeping step's predicted decrease that remains as the prediction for the next step.
constexpr double prediction_decay = 0.5;

/// A candidate at a kink where the state already is may help the next step to find a descent. The search ends after
/// this many in succession.
constexpr int max_steps_in_place = 3;

struct LineSearch {
  bool accepted = false;     ///< whether the objective's trial state is the accepted one
  Eigen::VectorXd step{};    ///< the part of the step that was travelled
  bool first_trial = false;  ///< whether it was accepted at the first trial
};

class Minimization {
 public:
  Minimization(Objective& objective, const MinimizerOptions& options, const Execution& execution,
               ShiftedCholesky* factorization)
      : objective_(objective),
        options_(options),
        execution_(execution),
        direction_(make_descent_direction(options, factorization, execution.cancellation)) {}

  MinimizerResult run() {
    current_ = evaluate(direction_->order());
    if (!std::isfinite(current_.value) || !current_.gradient.allFinite())
      throw Error("minimizer.not_finite", "The value or the gradient at the start of the minimization is not finite.");
    start_norm_ = current_.gradient.norm();
    record(0);
    while (true) {
      if (result_.gradient_norm <= options_.gradient_tolerance) return finish(MinimizerTermination::converged);
      if (near_saddle()) return finish(MinimizerTermination::saddle);
      if (result_.iterations >= options_.max_iterations) return finish(MinimizerTermination::iteration_limit);
      if (creeping_steps_ >= options_.max_stagnant_steps || steps_in_place_ >= max_steps_in_place)
        return finish(MinimizerTermination::step_too_small);
      report_progress();
      if (!iterate()) return finish(MinimizerTermination::step_too_small);
    }
  }

 private:
  Evaluation evaluate(int order) {
    execution_.cancellation.throw_if_requested();
    return objective_.evaluate(order);
  }

  /// Makes one accepted step. Returns false if none was found.
  bool iterate() {
    while (true) {
      Eigen::VectorXd d;
      {
        const StageTimer timer(execution_.cost, "step");
        d = direction_->direction(current_, objective_);
      }
      if (has_hessian()) result_.factorized_at = result_.iterations;
      const double slope = d.size() > 0 ? current_.gradient.dot(d) : 0;
      LineSearch search;
      if (slope < 0) search = uses_wolfe_condition() ? wolfe_search(d, slope) : line_search(d, slope);
      const double before = current_.value;
      const auto distance = search.first_trial ? std::nullopt : objective_.try_nonsmooth_candidates();
      if (distance || search.accepted) {
        if (distance) {
          take_candidate(*distance);
        } else {
          take_step(search);
        }
        count_creeping(before, slope);
        return true;
      }
      if (direction_->order() >= 2 && !has_hessian()) {
        // The reused factorization gave no step, so the next direction gets a factorization at this state.
        current_ = evaluate(2);
        continue;
      }
      if (d.size() == 0 || !direction_->retry()) return false;
    }
  }

  /// Updates the count after a step that began at this value and slope. MinimizerOptions::stagnation_fraction has the
  /// criterion.
  void count_creeping(double value, double slope) {
    // Regularized steps predict less, so the predictions of the creeping steps before them count for a while.
    predicted_decrease_ = std::max(creeping_steps_ > 0 ? prediction_decay * predicted_decrease_ : 0, -slope);
    const double min_decrease = options_.stagnation_fraction * predicted_decrease_;
    const bool is_measurable = min_decrease > options_.value_rounding * std::abs(value);
    creeping_steps_ = is_measurable && value - current_.value < min_decrease ? creeping_steps_ + 1 : 0;
    if (creeping_steps_ > options_.stagnant_steps_without_regularization) direction_->retry();
  }

  /// Whether |g| has fallen by the saddle contraction since the regularization was last reduced.
  bool near_saddle() {
    const MinimizerStep& last = result_.history.back();
    const bool regularized =
        last.regularization > 0 && last.regularization > reduced_regularization * last_regularization_;
    last_regularization_ = last.regularization;
    if (!regularized) saddle_reference_norm_ = last.gradient_norm;
    return regularized && last.gradient_norm <= options_.saddle_contraction * saddle_reference_norm_;
  }

  bool uses_wolfe_condition() const {
    return options_.method == MinimizerMethod::lbfgs && options_.slope_contraction > 0;
  }

  bool has_hessian() const { return !std::holds_alternative<std::monostate>(current_.hessian); }

  /// Evaluates at the trial state what the next direction needs.
  Evaluation evaluate_accepted() {
    if (options_.reuse_contraction > 0 && direction_->order() >= 2) {
      Evaluation trial_state = evaluate(1);
      if (direction_->reuses_factorization(trial_state.gradient.norm() / result_.gradient_norm)) return trial_state;
    }
    return evaluate(direction_->order());
  }

  LineSearch line_search(const Eigen::VectorXd& d, double slope) {
    const double length = d.norm();
    double t = std::min(1.0, objective_.largest_step(d));
    for (int trial = 0; trial <= options_.max_backtracks; ++trial) {
      if (!(t * length > options_.step_tolerance)) return {};
      Eigen::VectorXd travelled = objective_.move(t * d);
      if (!(travelled.norm() > options_.step_tolerance)) {
        // The motion was stopped at once, and shorter steps in this direction would be too.
        objective_.reject();
        return {};
      }
      const double value = evaluate(0).value;
      if (acceptable(value, current_.gradient.dot(travelled))) {
        if (trial == 0 && t == 1 && direction_->uses_modified_hessian()) return expand(d, value, std::move(travelled));
        return {.accepted = true, .step = std::move(travelled), .first_trial = trial == 0};
      }
      objective_.reject();
      t *= backtrack(value, t * slope);
    }
    return {};
  }

  /// Bisects or doubles the step until it satisfies both Wolfe conditions: the value has decreased enough and the slope
  /// has risen enough [Lewis2013, algorithm 2.6]. If no such step is found, the last one that lowered the value is
  /// accepted.
  LineSearch wolfe_search(const Eigen::VectorXd& d, double slope) {
    const double length = d.norm();
    const double max_step = objective_.largest_step(d);
    double low = 0;
    double high = std::numeric_limits<double>::infinity();
    double t = std::min(1.0, max_step);
    for (int trial = 0; trial <= options_.max_backtracks && t * length > options_.step_tolerance; ++trial) {
      Eigen::VectorXd travelled = objective_.move(t * d);
      if (!(travelled.norm() > options_.step_tolerance)) break;
      const double value = evaluate(0).value;
      if (!acceptable(value, current_.gradient.dot(travelled))) {
        objective_.reject();
        high = t;
        t = low > 0 ? 0.5 * (low + high) : t * backtrack(value, t * slope);
        continue;
      }
      // The travelled step as a direction at its end, along which the slope there is measured.
      Eigen::VectorXd transported = travelled;
      const bool transportable = objective_.transport(transported);
      const double end_slope = evaluate(1).gradient.dot(transported) / t;
      if (!transportable || end_slope >= options_.slope_contraction * slope || t >= max_step ||
          high - t <= options_.step_tolerance / length || trial == options_.max_backtracks)
        return {.accepted = true, .step = std::move(travelled), .first_trial = trial == 0};
      objective_.reject();
      low = t;
      t = high < std::numeric_limits<double>::infinity() ? 0.5 * (low + high) : std::min(2 * t, max_step);
    }
    objective_.reject();
    if (!(low > 0)) return {};
    Eigen::VectorXd travelled = objective_.move(low * d);
    evaluate(0);
    return {.accepted = true, .step = std::move(travelled), .first_trial = false};
  }

  /// Doubles the step d, whose trial state has this value, while the value falls. The trial state becomes the last one
  /// that was lower.
  LineSearch expand(const Eigen::VectorXd& d, double value, Eigen::VectorXd travelled) {
    double multiple = 1;
    while (2 * multiple <= options_.max_expansion && 2 * multiple <= objective_.largest_step(d)) {
      objective_.reject();
      Eigen::VectorXd longer_step = objective_.move(2 * multiple * d);
      const double longer_value = evaluate(0).value;
      if (!(longer_value < value)) {
        objective_.reject();
        travelled = objective_.move(multiple * d);
        break;
      }
      multiple *= 2;
      value = longer_value;
      travelled = std::move(longer_step);
    }
    return {.accepted = true, .step = std::move(travelled), .first_trial = true};
  }

  bool acceptable(double value, double predicted) {
    if (!std::isfinite(value)) return false;
    const double rounding = options_.value_rounding * std::max(std::abs(current_.value), std::abs(value));
    if (-predicted > rounding) return value <= current_.value + options_.armijo * predicted;
    return value <= current_.value + rounding &&
           evaluate(1).gradient.norm() <= (1 - options_.gradient_decrease) * result_.gradient_norm;
  }

  /// The factor from t to the minimum of the parabola that has the value of the current state and the slope `t_slope` /
  /// t at 0, and `value` at t.
  double backtrack(double value, double t_slope) const {
    const double curvature = value - current_.value - t_slope;
    const double factor =
        std::isfinite(value) && curvature > 0 ? -t_slope / (2 * curvature) : options_.max_backtrack_factor;
    return std::clamp(factor, options_.min_backtrack_factor, options_.max_backtrack_factor);
  }

  void take_step(LineSearch& search) {
    Eigen::VectorXd& step = search.step;
    const double length = step.norm();
    Eigen::VectorXd old_gradient = current_.gradient;
    current_ = evaluate_accepted();
    if (objective_.transport(step) && objective_.transport(old_gradient)) {
      direction_->transport(objective_);
      direction_->accepted(search.first_trial, step, old_gradient, current_.gradient);
    } else {
      direction_->forget();
    }
    objective_.accept();
    ++result_.iterations;
    steps_in_place_ = 0;
    record(length);
  }

  void take_candidate(double distance) {
    const double before = current_.value;
    current_ = evaluate(direction_->order());
    direction_->forget();
    objective_.accept();
    ++result_.iterations;
    steps_in_place_ = distance > 0 || current_.value < before ? 0 : steps_in_place_ + 1;
    record(distance);
  }

  void record(double step_length) {
    result_.value = current_.value;
    result_.gradient_norm = current_.gradient.norm();
    result_.history.push_back({result_.value, result_.gradient_norm, step_length, direction_->regularization()});
    if (options_.after_step) options_.after_step(result_.history.back());
  }

  void report_progress() {
    const double total = std::log(start_norm_) - std::log(std::max(options_.gradient_tolerance, 1e-300));
    const double done = std::log(start_norm_) - std::log(result_.gradient_norm);
    if (total > 0) progress_ = std::max(progress_, std::clamp(done / total, 0.0, 1.0));
    execution_.checkpoint(progress_, "step");
  }

  MinimizerResult finish(MinimizerTermination stop) {
    result_.stop = stop;
    result_.indefinite = direction_->met_indefinite();
    return std::move(result_);
  }

  Objective& objective_;
  const MinimizerOptions& options_;
  const Execution& execution_;
  std::unique_ptr<DescentDirection> direction_;
  Evaluation current_;  ///< evaluation at the current state
  double start_norm_ = 0;
  double last_regularization_ = 0;
  double saddle_reference_norm_ = 0;  ///< |g| at the last state that was reached with reduced or no regularization
  int creeping_steps_ = 0;            ///< number of creeping steps in succession
  double predicted_decrease_ = 0;     ///< see MinimizerOptions::stagnation_fraction
  int steps_in_place_ = 0;  ///< number of steps in succession that neither moved the state nor lowered the value
  double progress_ = 0;
  MinimizerResult result_;
};

}  // namespace

std::string_view to_string(MinimizerTermination stop) {
  switch (stop) {
    case MinimizerTermination::converged:
      return "converged";
    case MinimizerTermination::step_too_small:
      return "step_too_small";
    case MinimizerTermination::saddle:
      return "saddle";
    case MinimizerTermination::iteration_limit:
      break;
  }
  return "iteration_limit";
}

MinimizerResult minimize(Objective& objective, const MinimizerOptions& options, const Execution& execution,
                         ShiftedCholesky* factorization) {
  return Minimization(objective, options, execution, factorization).run();
}

}  // namespace supple::numerics
