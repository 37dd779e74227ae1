#include "supple/numerics/minimizer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "descent_direction.h"
#include "supple/base/error.h"

namespace supple::numerics {
namespace {

/// Less than this times as much regularization as in the last step is less; the scale of the Hessian varies a little.
constexpr double regularization_fell = 0.5;

/// Share of what a creeping step promised that counts at the next one.
constexpr double fading_promise = 0.5;

/// A kink at which the state already is may let the next step find its way. After so many of them in succession none
/// does.
constexpr int max_steps_in_place = 3;

struct LineSearch {
  bool accepted = false;   ///< the objective's trial state is the one accepted
  Eigen::VectorXd step{};  ///< that was travelled
  bool whole = false;      ///< accepted at the first trial
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
    at_ = evaluate(direction_->order());
    if (!std::isfinite(at_.value) || !at_.gradient.allFinite())
      throw Error("minimizer.not_finite", "The value or the gradient at the start of the minimization is not finite.");
    start_norm_ = at_.gradient.norm();
    record(0);
    while (true) {
      if (result_.gradient_norm <= options_.gradient_tolerance) return finish(MinimizerStop::converged);
      if (near_saddle()) return finish(MinimizerStop::saddle);
      if (result_.iterations >= options_.max_iterations) return finish(MinimizerStop::iteration_limit);
      if (creeping_ >= options_.max_creeping_steps || in_place_ >= max_steps_in_place)
        return finish(MinimizerStop::step_too_small);
      report_progress();
      if (!iterate()) return finish(MinimizerStop::step_too_small);
    }
  }

 private:
  Evaluation evaluate(int order) {
    execution_.cancellation.throw_if_requested();
    return objective_.evaluate(order);
  }

  /// One accepted step; false where none was found.
  bool iterate() {
    while (true) {
      Eigen::VectorXd d;
      {
        const StageTimer timer(execution_.cost, "step");
        d = direction_->direction(at_, objective_);
      }
      if (has_hessian()) result_.factorized_at = result_.iterations;
      const double slope = d.size() > 0 ? at_.gradient.dot(d) : 0;
      LineSearch search;
      if (slope < 0) search = raises_slope() ? wolfe_search(d, slope) : line_search(d, slope);
      const double before = at_.value;
      const auto distance = search.whole ? std::nullopt : objective_.snap();
      if (distance || search.accepted) {
        if (distance) {
          take_snap(*distance);
        } else {
          take_step(search);
        }
        count_creeping(before, slope);
        return true;
      }
      if (direction_->order() >= 2 && !has_hessian()) {
        // The kept factorization led nowhere: the next direction comes from one of this state.
        at_ = evaluate(2);
        continue;
      }
      if (d.size() == 0 || !direction_->retry()) return false;
    }
  }

  /// After a step from a state of this value and slope.
  void count_creeping(double value, double slope) {
    // Regularized steps promise less: for a while those count that crept before them.
    promise_ = std::max(creeping_ > 0 ? fading_promise * promise_ : 0, -slope);
    const double least_decrease = options_.creeping_share * promise_;
    const bool is_measurable = least_decrease > options_.value_rounding * std::abs(value);
    creeping_ = is_measurable && value - at_.value < least_decrease ? creeping_ + 1 : 0;
    if (creeping_ > options_.creeping_steps_without_regularization) direction_->retry();
  }

  /// Whether |g| has fallen by the contraction asked for while the regularization could not.
  bool near_saddle() {
    const MinimizerStep& last = result_.history.back();
    const bool regularized =
        last.regularization > 0 && last.regularization > regularization_fell * last_regularization_;
    last_regularization_ = last.regularization;
    if (!regularized) indefinite_since_ = last.gradient_norm;
    return regularized && last.gradient_norm <= options_.saddle_contraction * indefinite_since_;
  }

  bool raises_slope() const { return options_.method == MinimizerMethod::lbfgs && options_.slope_contraction > 0; }

  bool has_hessian() const { return !std::holds_alternative<std::monostate>(at_.hessian); }

  /// What the next direction needs, at the trial state.
  Evaluation evaluate_accepted() {
    if (options_.reuse_contraction > 0 && direction_->order() >= 2) {
      Evaluation at = evaluate(1);
      if (direction_->keeps(at.gradient.norm() / result_.gradient_norm)) return at;
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
        // Stopped at once: shorter steps the same way would be too.
        objective_.reject();
        return {};
      }
      const double value = evaluate(0).value;
      if (acceptable(value, at_.gradient.dot(travelled))) {
        if (trial == 0 && t == 1 && direction_->is_rough()) return expand(d, value, std::move(travelled));
        return {.accepted = true, .step = std::move(travelled), .whole = trial == 0};
      }
      objective_.reject();
      t *= backtrack(value, t * slope);
    }
    return {};
  }

  /// Halves and doubles the step until it is neither too long for the decrease of the value nor too short for that of
  /// the slope (Lewis and Overton 2013, algorithm 2.6). The last step that has lowered the value is good enough where
  /// no other is left.
  LineSearch wolfe_search(const Eigen::VectorXd& d, double slope) {
    const double length = d.norm();
    const double longest = objective_.largest_step(d);
    double low = 0;
    double high = std::numeric_limits<double>::infinity();
    double t = std::min(1.0, longest);
    for (int trial = 0; trial <= options_.max_backtracks && t * length > options_.step_tolerance; ++trial) {
      Eigen::VectorXd travelled = objective_.move(t * d);
      if (!(travelled.norm() > options_.step_tolerance)) break;
      const double value = evaluate(0).value;
      if (!acceptable(value, at_.gradient.dot(travelled))) {
        objective_.reject();
        high = t;
        t = low > 0 ? 0.5 * (low + high) : t * backtrack(value, t * slope);
        continue;
      }
      // Along the way as it goes on at its end.
      Eigen::VectorXd onwards = travelled;
      const bool known = objective_.transport(onwards);
      const double end_slope = evaluate(1).gradient.dot(onwards) / t;
      if (!known || end_slope >= options_.slope_contraction * slope || t >= longest ||
          high - t <= options_.step_tolerance / length || trial == options_.max_backtracks)
        return {.accepted = true, .step = std::move(travelled), .whole = trial == 0};
      objective_.reject();
      low = t;
      t = high < std::numeric_limits<double>::infinity() ? 0.5 * (low + high) : std::min(2 * t, longest);
    }
    objective_.reject();
    if (!(low > 0)) return {};
    Eigen::VectorXd travelled = objective_.move(low * d);
    evaluate(0);
    return {.accepted = true, .step = std::move(travelled), .whole = false};
  }

  /// From the trial state of the whole step, of that value, to longer ones; the trial state is the longest good one.
  LineSearch expand(const Eigen::VectorXd& d, double value, Eigen::VectorXd travelled) {
    double reached = 1;
    while (2 * reached <= options_.longest_expansion && 2 * reached <= objective_.largest_step(d)) {
      objective_.reject();
      Eigen::VectorXd farther = objective_.move(2 * reached * d);
      const double longer = evaluate(0).value;
      if (!(longer < value)) {
        objective_.reject();
        travelled = objective_.move(reached * d);
        break;
      }
      reached *= 2;
      value = longer;
      travelled = std::move(farther);
    }
    return {.accepted = true, .step = std::move(travelled), .whole = true};
  }

  bool acceptable(double value, double predicted) {
    if (!std::isfinite(value)) return false;
    const double rounding = options_.value_rounding * std::max(std::abs(at_.value), std::abs(value));
    if (-predicted > rounding) return value <= at_.value + options_.armijo * predicted;
    return value <= at_.value + rounding &&
           evaluate(1).gradient.norm() <= (1 - options_.gradient_decrease) * result_.gradient_norm;
  }

  /// The factor that takes t to the minimum of the parabola with value at_.value and slope `t_slope` / t at 0 and
  /// `value` at t.
  double backtrack(double value, double t_slope) const {
    const double curvature = value - at_.value - t_slope;
    const double factor =
        std::isfinite(value) && curvature > 0 ? -t_slope / (2 * curvature) : options_.longest_backtrack;
    return std::clamp(factor, options_.shortest_backtrack, options_.longest_backtrack);
  }

  void take_step(LineSearch& search) {
    Eigen::VectorXd& step = search.step;
    const double length = step.norm();
    Eigen::VectorXd old_gradient = at_.gradient;
    at_ = evaluate_accepted();
    if (objective_.transport(step) && objective_.transport(old_gradient)) {
      direction_->transport(objective_);
      direction_->accepted(search.whole, step, old_gradient, at_.gradient);
    } else {
      direction_->forget();
    }
    objective_.accept();
    ++result_.iterations;
    in_place_ = 0;
    record(length);
  }

  void take_snap(double distance) {
    const double before = at_.value;
    at_ = evaluate(direction_->order());
    direction_->forget();
    objective_.accept();
    ++result_.iterations;
    in_place_ = distance > 0 || at_.value < before ? 0 : in_place_ + 1;
    record(distance);
  }

  void record(double step_length) {
    result_.value = at_.value;
    result_.gradient_norm = at_.gradient.norm();
    result_.history.push_back({result_.value, result_.gradient_norm, step_length, direction_->regularization()});
    if (options_.after_step) options_.after_step(result_.history.back());
  }

  void report_progress() {
    const double whole = std::log(start_norm_) - std::log(std::max(options_.gradient_tolerance, 1e-300));
    const double done = std::log(start_norm_) - std::log(result_.gradient_norm);
    if (whole > 0) progress_ = std::max(progress_, std::clamp(done / whole, 0.0, 1.0));
    execution_.checkpoint(progress_, "step");
  }

  MinimizerResult finish(MinimizerStop stop) {
    result_.stop = stop;
    result_.indefinite = direction_->met_indefinite();
    return std::move(result_);
  }

  Objective& objective_;
  const MinimizerOptions& options_;
  const Execution& execution_;
  std::unique_ptr<DescentDirection> direction_;
  Evaluation at_;  ///< at the current state
  double start_norm_ = 0;
  double last_regularization_ = 0;
  double indefinite_since_ = 0;  ///< |g| of the last state to which a step with less regularization led, or none
  int creeping_ = 0;             ///< steps in succession that creep
  double promise_ = 0;           ///< what counts of their |g . d|
  int in_place_ = 0;             ///< steps in succession that neither moved the state nor lowered the value
  double progress_ = 0;
  MinimizerResult result_;
};

}  // namespace

std::string_view to_string(MinimizerStop stop) {
  switch (stop) {
    case MinimizerStop::converged:
      return "converged";
    case MinimizerStop::step_too_small:
      return "step_too_small";
    case MinimizerStop::saddle:
      return "saddle";
    case MinimizerStop::iteration_limit:
      break;
  }
  return "iteration_limit";
}

MinimizerResult minimize(Objective& objective, const MinimizerOptions& options, const Execution& execution,
                         ShiftedCholesky* factorization) {
  return Minimization(objective, options, execution, factorization).run();
}

}  // namespace supple::numerics
