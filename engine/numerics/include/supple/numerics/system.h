#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/numerics/derivative_check.h"
#include "supple/numerics/nonsmooth_search.h"
#include "supple/numerics/objective.h"
#include "supple/numerics/state.h"
#include "supple/numerics/term.h"
#include "supple/numerics/unknowns.h"

namespace supple::numerics {

struct SystemOptions {
  Execution
      execution{};  ///< its ledger is billed for every term, and its token stops evaluations; it outlives the system
  /// Derivatives up to this order are evaluated whenever the value is asked for. It pays if most trial states are
  /// accepted and derivatives cost little more than the value.
  int min_order = 0;
  /// The sums of another system with the same unknowns and terms, so that the Hessian's pattern is known. Only one
  /// system may use them at a time.
  std::shared_ptr<EnergySum> sums{};
};

/// A state and the terms of a scene as one objective: E is the sum of the terms. No other class implements `Objective`
/// for sums of energies. It owns the unknowns, the trial state, the last evaluation and the bill.
template <State S>
class System : public Objective {
 public:
  using Terms = std::vector<std::shared_ptr<Term<S>>>;

  using Search = std::shared_ptr<const NonsmoothSearch<S>>;

  /// `search` is null where the energy is differentiable, or where nothing is known of the places where it is not.
  System(S state, Terms terms, Unknowns unknowns, SystemOptions options = {}, Search search = nullptr)
      : state_(std::move(state)),
        terms_(std::move(terms)),
        unknowns_(std::move(unknowns)),
        options_(std::move(options)),
        search_(std::move(search)),
        sums_(options_.sums ? options_.sums : std::make_shared<EnergySum>()) {
    if constexpr (Stoppable<S>) state_.stop_with(options_.execution.cancellation);
    if (!options_.sums) sums_->hessian = HessianEntries(unknowns_.numbering());
  }

  /// The current state.
  const S& state() const { return state_; }
  /// The current state after every term has prepared it for its value. There must be no trial state.
  const S& prepared_state() {
    for (const auto& term : terms_)
      if (term->active()) term->prepare(state_, 0, options_.execution);
    return state_;
  }
  /// Makes another state the current one and discards the trial state. If the terms have not looked ahead to it,
  /// `look_ahead` has to be called next.
  void set_state(S state) {
    trial_.reset();
    state_ = std::move(state);
    if constexpr (Stoppable<S>) state_.stop_with(options_.execution.cancellation);
    has_frame_ = false;
    forget();
    forget_trials();
  }
  /// Discards the last evaluation, because a term has changed.
  void forget() { evaluated_order_ = -1; }

  const Unknowns& unknowns() const { return unknowns_; }
  const Terms& terms() const { return terms_; }
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return unknowns_.expand(y); }
  Eigen::VectorXd restrict(const Eigen::VectorXd& x) const { return unknowns_.restrict(x); }

  /// The fraction of the step between two states that every term allows. The terms are then ready for all states on
  /// that part of it.
  double look_ahead(const S& from, const S& to) {
    double fraction = 1;
    std::optional<S> end;
    for (const auto& term : terms_) {
      const double allowed = std::clamp(term->look_ahead(from, end ? *end : to, options_.execution.cost), 0.0, 1.0);
      if (allowed >= 1) continue;
      fraction *= allowed;
      if constexpr (Retractable<S>) {
        end = to;
        end->shorten_move(from, fraction);
      }
    }
    return fraction;
  }
  /// Prepares the terms for the current state, after it was replaced or one of them has changed.
  void prepare_terms() { look_ahead(state_, state_); }

  Eigen::Index dimension() const override { return unknowns_.size(); }

  Evaluation evaluate(int order) override {
    evaluate_terms(order);
    Evaluation evaluation;
    evaluation.value = sums_->value;
    if (order >= 1) evaluation.gradient = unknowns_.restrict(sums_->gradient);
    if (order >= 2) evaluation.hessian = std::shared_ptr<const BorderedMatrix>(hessian_);
    return evaluation;
  }

  std::optional<Hessian> convex_hessian() override {
    if (trial_ || evaluated_order_ < 2 ||
        std::ranges::none_of(terms_, [](const auto& term) { return term->active() && term->has_convex_hessian(); }))
      return std::nullopt;
    evaluated_order_ = -1;
    sums_->convex = true;
    hessian_.swap(convex_);
    evaluate_terms(2);
    hessian_.swap(convex_);
    sums_->convex = false;
    evaluated_order_ = 1;  // the sum is not the Hessian
    return std::shared_ptr<const BorderedMatrix>(convex_);
  }

  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    set_trial(state_);
    Eigen::VectorXd travelled;
    {
      const StageTimer timer(S::motion.empty() ? nullptr : options_.execution.cost, S::motion);
      travelled = unknowns_.restrict(trial_->move(unknowns_.expand(step)));
    }
    if (const double fraction = look_ahead(state_, *trial_); fraction < 1) {
      travelled *= fraction;
      if constexpr (Retractable<S>) {
        trial_->shorten_move(state_, fraction);
      } else {
        trial_ = state_;
        travelled = unknowns_.restrict(trial_->move(unknowns_.expand(travelled)));
      }
    }
    if (search_) longest_step_ = std::max(longest_step_, travelled.norm());
    return travelled;
  }

  void accept() override {
    state_ = std::move(*trial_);
    trial_.reset();
    has_frame_ = trial_has_frame_;
    value_ = trial_value_;
    forget_trials();
  }

  void reject() override {
    // The search may use the trial state with everything that was computed at it.
    if (search_ && trial_) trials_.push_back(std::move(*trial_));
    trial_.reset();
    forget();
  }

  /// The smallest of the terms' largest steps.
  double largest_step(const Eigen::VectorXd& step) const override {
    const Eigen::VectorXd all = unknowns_.expand(step);
    double largest = std::numeric_limits<double>::infinity();
    for (const auto& term : terms_) largest = std::min(largest, term->largest_step(state_, all));
    return largest;
  }

  bool transport(Eigen::VectorXd& tangent) const override {
    Eigen::VectorXd all = unknowns_.expand(tangent);
    if (!(trial_ ? *trial_ : state_).transport(all)) return false;
    tangent = unknowns_.restrict(all);
    return true;
  }

  /// Tries the candidates of the search. Each is tried once for a current state.
  std::optional<double> try_nonsmooth_candidates() override {
    if (!search_) return std::nullopt;
    double best = trial_ ? std::min(value_, trial_value_) : value_;
    std::optional<S> found;
    if (trial_) trials_.push_back(*trial_);
    std::optional<S> before = std::exchange(trial_, std::nullopt);
    double distance = 0;
    for (auto& candidate : search_->candidates(state_, trials_, longest_step_)) {
      if (std::ranges::find(tried_candidates_, candidate.id) != tried_candidates_.end()) continue;
      tried_candidates_.push_back(candidate.id);
      set_trial(std::move(candidate.state));
      if constexpr (Stoppable<S>) trial_->stop_with(options_.execution.cancellation);
      const double value = evaluate(0).value;
      // A candidate from which only rounding separates the state has the state's value, or one below it by rounding. It
      // is still taken if trial states close to it are lower by hardly more than rounding.
      const bool is_worse =
          value > value_ + value_tolerance * std::abs(value_) || value > best + min_decrease * std::abs(best);
      if (candidate.coincides ? is_worse : !(value < best)) continue;
      best = value;
      distance = candidate.distance;
      found = std::move(trial_);
    }
    const bool improved = found.has_value();
    trial_ = improved ? std::move(found) : std::move(before);
    trial_has_frame_ = false;
    forget();
    return improved ? std::optional<double>(distance) : std::nullopt;
  }

  // Results of the last evaluation:
  double energy() const { return sums_->value; }
  /// Derivatives with respect to all degrees of freedom at the current state. The entries of fixed ones are reactions.
  const Eigen::VectorXd& full_gradient() {
    evaluate_terms(1);
    return sums_->gradient;
  }
  // The Hessian of the last evaluation of order 2, without its low-rank part. The core is that of the unknowns. The
  // border has all degrees of freedom of the border, not only their movements along the directions.
  const SparseMatrix& core() const { return hessian_->core; }
  const Eigen::MatrixXd& border() const { return border_; }
  const Eigen::MatrixXd& corner() const { return corner_; }

 private:
  /// Relative difference below which two values are equal up to rounding.
  static constexpr double value_tolerance = 1e-12;
  /// Relative decrease below which a step makes no progress.
  static constexpr double min_decrease = 1e-10;

  void set_trial(S state) {
    trial_ = std::move(state);
    trial_has_frame_ = false;
    trial_value_ = std::numeric_limits<double>::infinity();
    forget();
  }

  void forget_trials() {
    trials_.clear();
    tried_candidates_.clear();
    longest_step_ = 0;
  }

  /// Evaluates the terms at the trial state if there is one, otherwise at the current state, at least up to this order.
  void evaluate_terms(int order) {
    if (order <= evaluated_order_) return;
    order = std::max(order, options_.min_order);
    S& state = trial_ ? *trial_ : state_;
    bool& has_frame = trial_ ? trial_has_frame_ : has_frame_;
    if (order >= 1 && !has_frame) {
      state.take_frame();
      has_frame = true;
    }
    sums_->cancellation = &options_.execution.cancellation;
    sums_->hessian.stop_with(&options_.execution.cancellation);
    sums_->clear(state.dimension(), order);
    for (const auto& term : terms_) {
      if (!term->active()) continue;
      options_.execution.cancellation.throw_if_requested();
      term->prepare(state, order, options_.execution);
      const auto start = Clock::now();
      term->add(state, order, *sums_);
      if (CostLedger* cost = options_.execution.cost)
        term->bill(*cost, std::chrono::duration<double>(Clock::now() - start).count());
    }
    evaluated_order_ = order;
    (trial_ ? trial_value_ : value_) = sums_->value;
    if (order >= 2) assemble(state.dimension());
  }

  void assemble(Eigen::Index degrees_of_freedom) {
    sums_->hessian.assemble(degrees_of_freedom, *hessian_);
    border_.swap(hessian_->border);
    corner_.swap(hessian_->corner);
    const Eigen::MatrixXd& directions = unknowns_.directions();
    hessian_->border = border_ * directions;
    hessian_->corner = directions.transpose() * corner_ * directions;
    hessian_->low_rank.resize(dimension(), static_cast<Eigen::Index>(sums_->rank_one.size()));
    for (Eigen::Index k = 0; k < hessian_->low_rank.cols(); ++k)
      hessian_->low_rank.col(k) = unknowns_.restrict(sums_->rank_one[static_cast<std::size_t>(k)]);
  }

  using Clock = std::chrono::steady_clock;

  S state_;
  std::optional<S> trial_;
  bool has_frame_ = false;  ///< whether the state has taken the frame of its place
  bool trial_has_frame_ = false;
  Terms terms_;
  Unknowns unknowns_;
  SystemOptions options_;
  Search search_;

  std::shared_ptr<EnergySum> sums_;
  /// Order of derivatives that the sums hold for the trial state, or else for the current one; -1 for none.
  int evaluated_order_ = -1;
  double value_ = std::numeric_limits<double>::infinity();  ///< energy of the current state
  double trial_value_ = std::numeric_limits<double>::infinity();
  std::shared_ptr<BorderedMatrix> hessian_ = std::make_shared<BorderedMatrix>();
  std::shared_ptr<BorderedMatrix> convex_ = std::make_shared<BorderedMatrix>();
  Eigen::MatrixXd border_;
  Eigen::MatrixXd corner_;

  // Recorded for the search since the last change of the current state:
  std::vector<S> trials_;  ///< trial states
  std::vector<std::int64_t> tried_candidates_;
  double longest_step_ = 0;  ///< longest step that was travelled
};

/// Compares a term's derivatives at a state with finite differences along the state's retraction; see DerivativeCheck.
template <State S>
DerivativeCheck check_derivatives(Term<S>& term, const std::type_identity_t<S>& state,
                                  const DerivativeCheckOptions& options = {}) {
  const std::shared_ptr<Term<S>> unowned(std::shared_ptr<void>(), &term);
  System<S> system(state, {unowned}, Unknowns(state.dimension()));
  return check_derivatives(system, options);
}

}  // namespace supple::numerics
