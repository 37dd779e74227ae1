#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/numerics/derivative_check.h"
#include "supple/numerics/objective.h"
#include "supple/numerics/state.h"
#include "supple/numerics/term.h"
#include "supple/numerics/unknowns.h"

namespace supple::numerics {

struct SystemOptions {
  Execution
      execution{};  ///< whose ledger is billed for every term, and whose stop ends evaluations; outlives the system
  /// Derivatives up to this order are evaluated wherever the value is asked for: most trial states are accepted, and
  /// these cost little more than the value.
  int least_order = 0;
  /// The sums of another system with the same unknowns and the same terms: its Hessian's places are known. Used by one
  /// system at a time.
  std::shared_ptr<EnergySum> sums{};
};

/// A state and the terms that a scene calls for, as one objective: E = the sum of the terms. The only objective for
/// sums of energies: what is held, the trial state, what was evaluated, and the bill are kept here and nowhere else.
template <State S>
class System : public Objective {
 public:
  using Terms = std::vector<std::shared_ptr<Term<S>>>;

  System(S state, Terms terms, Unknowns unknowns, SystemOptions options = {})
      : state_(std::move(state)),
        terms_(std::move(terms)),
        unknowns_(std::move(unknowns)),
        options_(std::move(options)),
        sums_(options_.sums ? options_.sums : std::make_shared<EnergySum>()) {
    if constexpr (Stoppable<S>) state_.stop_with(options_.execution.cancellation);
    if (!options_.sums) sums_->hessian = HessianEntries(unknowns_.numbering());
    keeps_tried_ = std::ranges::any_of(terms_, [](const auto& term) { return term->has_kinks(); });
  }

  /// The current state.
  const S& state() const { return state_; }
  /// Makes another state the current one and forgets the trial state. It is one that the terms looked ahead to, or
  /// `look_ahead` is called next.
  void set_state(S state) {
    trial_.reset();
    state_ = std::move(state);
    if constexpr (Stoppable<S>) state_.stop_with(options_.execution.cancellation);
    framed_ = false;
    forget();
    forget_trials();
  }
  /// A term has changed: what was evaluated no longer holds.
  void forget() { evaluated_ = -1; }

  const Unknowns& unknowns() const { return unknowns_; }
  const Terms& terms() const { return terms_; }
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return unknowns_.expand(y); }
  Eigen::VectorXd restrict(const Eigen::VectorXd& x) const { return unknowns_.restrict(x); }

  /// The share of the way between two states that every term allows. The terms are then ready for all states on that
  /// part of it.
  double look_ahead(const S& from, const S& to) {
    double share = 1;
    std::optional<S> end;
    for (const auto& term : terms_) {
      const double allowed = std::clamp(term->look_ahead(from, end ? *end : to, options_.execution.cost), 0.0, 1.0);
      if (allowed >= 1) continue;
      share *= allowed;
      if constexpr (Retractable<S>) {
        end = to;
        end->go_back(from, share);
      }
    }
    return share;
  }
  /// The terms get ready for the current state, after it was replaced or one of them has changed.
  void look_around() { look_ahead(state_, state_); }

  Eigen::Index dimension() const override { return unknowns_.size(); }

  Evaluation evaluate(int order) override {
    sum_up(order);
    Evaluation evaluation;
    evaluation.value = sums_->value;
    if (order >= 1) evaluation.gradient = unknowns_.restrict(sums_->gradient);
    if (order >= 2) evaluation.hessian = std::shared_ptr<const BorderedMatrix>(hessian_);
    return evaluation;
  }

  std::optional<Hessian> convex_hessian() override {
    if (trial_ || evaluated_ < 2 ||
        std::ranges::none_of(terms_, [](const auto& term) { return term->active() && term->has_convex_hessian(); }))
      return std::nullopt;
    evaluated_ = -1;
    sums_->convex = true;
    hessian_.swap(convex_);
    sum_up(2);
    hessian_.swap(convex_);
    sums_->convex = false;
    evaluated_ = 1;  // what was added up is not the Hessian
    return std::shared_ptr<const BorderedMatrix>(convex_);
  }

  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    set_trial(state_);
    Eigen::VectorXd travelled;
    {
      const StageTimer timer(S::motion.empty() ? nullptr : options_.execution.cost, S::motion);
      travelled = unknowns_.restrict(trial_->move(unknowns_.expand(step)));
    }
    if (const double share = look_ahead(state_, *trial_); share < 1) {
      travelled *= share;
      if constexpr (Retractable<S>) {
        trial_->go_back(state_, share);
      } else {
        trial_ = state_;
        travelled = unknowns_.restrict(trial_->move(unknowns_.expand(travelled)));
      }
    }
    if (keeps_tried_) reach_ = std::max(reach_, travelled.norm());
    return travelled;
  }

  void accept() override {
    state_ = std::move(*trial_);
    trial_.reset();
    framed_ = framed_trial_;
    value_ = trial_value_;
    forget_trials();
  }

  void reject() override {
    // With what was worked out for it.
    if (keeps_tried_ && trial_) tried_.push_back(std::move(*trial_));
    trial_.reset();
    forget();
  }

  /// The least of the terms' largest steps.
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

  /// Tries the kinks that the terms know of nearby, each once for a current state.
  std::optional<double> snap() override {
    if (!keeps_tried_) return std::nullopt;
    double best = trial_ ? std::min(value_, trial_value_) : value_;
    std::optional<S> found;
    if (trial_) tried_.push_back(*trial_);
    std::optional<S> before = std::exchange(trial_, std::nullopt);
    double distance = 0;
    for (const auto& term : terms_) {
      for (auto& kink : term->kinks(state_, tried_, reach_)) {
        if (std::ranges::find(kinks_tried_, kink.id) != kinks_tried_.end()) continue;
        kinks_tried_.push_back(kink.id);
        set_trial(std::move(kink.state));
        const double value = evaluate(0).value;
        // A state that rounding alone keeps from the kink has the kink's value, or one below it by rounding. Trial
        // states so close to it that they hardly fall below are no reason to pass it by.
        const bool is_worse =
            value > value_ + same_value * std::abs(value_) || value > best + smallest_decrease * std::abs(best);
        if (kink.same_place ? is_worse : !(value < best)) continue;
        best = value;
        distance = kink.distance;
        found = std::move(trial_);
      }
    }
    const bool snapped = found.has_value();
    trial_ = snapped ? std::move(found) : std::move(before);
    framed_trial_ = false;
    forget();
    return snapped ? std::optional<double>(distance) : std::nullopt;
  }

  // The results of the last evaluation:
  double energy() const { return sums_->value; }
  /// Derivatives by all degrees of freedom at the current state; those by held ones are reactions.
  const Eigen::VectorXd& full_gradient() {
    sum_up(1);
    return sums_->gradient;
  }
  // The Hessian of the last evaluation of order 2, without what is of low rank: the core of the unknowns, and the
  // border for all of the border's degrees of freedom, not only along the directions.
  const SparseMatrix& core() const { return hessian_->core; }
  const Eigen::MatrixXd& border() const { return border_; }
  const Eigen::MatrixXd& corner() const { return corner_; }

 private:
  /// Values that differ by less than this, relative, differ by rounding.
  static constexpr double same_value = 1e-12;
  /// Decreases by less than this, relative, are those of a step on which no progress is made.
  static constexpr double smallest_decrease = 1e-10;

  void set_trial(S state) {
    trial_ = std::move(state);
    framed_trial_ = false;
    trial_value_ = std::numeric_limits<double>::infinity();
    forget();
  }

  void forget_trials() {
    tried_.clear();
    kinks_tried_.clear();
    reach_ = 0;
  }

  /// Makes `sums_` those of the present state, the trial state if there is one, up to the order at least.
  void sum_up(int order) {
    if (order <= evaluated_) return;
    order = std::max(order, options_.least_order);
    S& state = trial_ ? *trial_ : state_;
    bool& framed = trial_ ? framed_trial_ : framed_;
    if (order >= 1 && !framed) {
      state.take_frame();
      framed = true;
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
    evaluated_ = order;
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
  bool framed_ = false;  ///< the state has the frame of the place where it is
  bool framed_trial_ = false;
  Terms terms_;
  Unknowns unknowns_;
  SystemOptions options_;

  std::shared_ptr<EnergySum> sums_;
  int evaluated_ = -1;  ///< order of derivatives of the present state that the sums hold; -1 for none
  double value_ = std::numeric_limits<double>::infinity();  ///< of the current state
  double trial_value_ = std::numeric_limits<double>::infinity();
  std::shared_ptr<BorderedMatrix> hessian_ = std::make_shared<BorderedMatrix>();
  std::shared_ptr<BorderedMatrix> convex_ = std::make_shared<BorderedMatrix>();
  Eigen::MatrixXd border_;
  Eigen::MatrixXd corner_;

  // Since the current state became that, where a term has kinks:
  bool keeps_tried_ = false;
  std::vector<S> tried_;  ///< trial states
  std::vector<std::int64_t> kinks_tried_;
  double reach_ = 0;  ///< the longest step that was travelled
};

/// Compares a term's derivatives at a state with finite differences, along the state's retraction; see DerivativeCheck.
template <State S>
DerivativeCheck check_derivatives(Term<S>& term, const std::type_identity_t<S>& state,
                                  const DerivativeCheckOptions& options = {}) {
  const std::shared_ptr<Term<S>> unowned(std::shared_ptr<void>(), &term);
  System<S> system(state, {unowned}, Unknowns(state.dimension()));
  return check_derivatives(system, options);
}

}  // namespace supple::numerics
