#include "weave_objective.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

namespace supple::weave {

WeaveObjective::WeaveObjective(const RodModel& model, Eigen::VectorXd q, Chart chart, const std::vector<bool>& held,
                               const EnergyOptions& options, std::vector<PointForces::Load> forces, CostLedger* cost)
    : model_(model), q_(std::move(q)), chart_(std::move(chart)), cost_(cost) {
  numbering_.resize(held.size());
  for (std::size_t i = 0; i < held.size(); ++i) numbering_[i] = held[i] ? -1 : static_cast<int>(unknowns_++);
  sum_.hessian = numerics::HessianEntries(unknowns_);

  terms_.push_back(std::make_shared<StretchEnergy>(model, numbering_));
  const bool jointed = model.joints() > 0;
  for (const TurnKind kind : {TurnKind::free, TurnKind::jointed}) {
    if (kind == TurnKind::jointed && !jointed) continue;
    if (model.spatial()) {
      terms_.push_back(std::make_shared<SpatialBendEnergy>(model, numbering_, chart_, kind));
      terms_.push_back(std::make_shared<TwistEnergy>(model, numbering_, chart_, kind));
    } else {
      terms_.push_back(std::make_shared<PlanarBendEnergy>(model, numbering_, kind));
    }
  }
  if (!model.sliders().empty()) {
    limits_ = std::make_shared<SlidingLimits>(model, numbering_, options.barrier_range, options.barrier_stiffness);
    contact_ = std::make_shared<CrossingContact>(model, numbering_, options.least_distance, options.barrier_range,
                                                 options.barrier_stiffness);
    if (!limits_->empty()) terms_.push_back(limits_);
    if (!contact_->empty()) terms_.push_back(contact_);
    terms_.push_back(std::make_shared<SlidingRegularizer>(model, numbering_, options.sliding_regularization));
  }
  if (!forces.empty()) {
    forces_ = std::make_shared<PointForces>(std::move(forces));
    terms_.push_back(forces_);
  }
}

void WeaveObjective::set_state(Eigen::VectorXd q, Chart chart) {
  q_ = std::move(q);
  chart_ = std::move(chart);
  if (model_.spatial()) chart_ = rebase(model_, chart_, q_);
}

void WeaveObjective::set_force_share(double share) {
  if (forces_) forces_->set_share(share);
}

Eigen::VectorXd WeaveObjective::expand(const Eigen::VectorXd& y) const {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model_.size());
  for (std::size_t i = 0; i < numbering_.size(); ++i)
    if (numbering_[i] >= 0) q[static_cast<Eigen::Index>(i)] = y[numbering_[i]];
  return q;
}

Eigen::VectorXd WeaveObjective::restrict(const Eigen::VectorXd& q) const {
  Eigen::VectorXd y(unknowns_);
  for (std::size_t i = 0; i < numbering_.size(); ++i)
    if (numbering_[i] >= 0) y[numbering_[i]] = q[static_cast<Eigen::Index>(i)];
  return y;
}

void WeaveObjective::add_terms(int order) {
  using Clock = std::chrono::steady_clock;
  const Eigen::VectorXd& x = state();
  sum_.value = 0;
  if (order >= 1) sum_.gradient.setZero(x.size());
  if (order >= 2) sum_.hessian.clear();
  for (const auto& term : terms_) {
    if (!cost_) {
      term->add(x, order, sum_);
      continue;
    }
    const auto start = Clock::now();
    term->add(x, order, sum_);
    cost_->add_effect(term->name(), true, "a term of the weave", 1,
                      std::chrono::duration<double>(Clock::now() - start).count());
  }
}

numerics::Evaluation WeaveObjective::evaluate(int order) {
  if (order >= 1 && model_.spatial()) {
    if (has_trial_ && !rebased_) {
      before_ = chart_;
      rebased_ = true;
    }
    chart_ = rebase(model_, chart_, state());
  }
  add_terms(order);
  numerics::Evaluation evaluation;
  evaluation.value = sum_.value;
  if (order >= 1) evaluation.gradient = restrict(sum_.gradient);
  if (order >= 2) {
    sum_.hessian.assemble(unknowns_, *hessian_);
    evaluation.hessian = std::shared_ptr<const numerics::BorderedMatrix>(hessian_);
  }
  return evaluation;
}

Eigen::VectorXd WeaveObjective::full_gradient() {
  if (model_.spatial()) chart_ = rebase(model_, chart_, q_);
  add_terms(1);
  return sum_.gradient;
}

double WeaveObjective::move(const Eigen::VectorXd& step) {
  trial_ = q_ + expand(step);
  has_trial_ = true;
  rebased_ = false;
  return 1;
}

void WeaveObjective::accept() {
  q_ = std::move(trial_);
  has_trial_ = false;
  rebased_ = false;
}

void WeaveObjective::reject() {
  if (rebased_) chart_ = std::move(before_);
  has_trial_ = false;
  rebased_ = false;
}

double WeaveObjective::largest_step(const Eigen::VectorXd& step) const {
  const Eigen::VectorXd full = expand(step);
  double largest = std::numeric_limits<double>::infinity();
  for (const auto& term : terms_) largest = std::min(largest, term->largest_step(q_, full));
  return largest;
}

std::vector<bool> free_but_for_gauges(const RodModel& model) {
  std::vector<bool> held(static_cast<std::size_t>(model.size()), false);
  const auto hold = [&held](int dof) { held[static_cast<std::size_t>(dof)] = true; };
  for (int i = 0; i < static_cast<int>(model.sliders().size()); ++i) {
    const Slider& slider = model.sliders()[static_cast<std::size_t>(i)];
    if (!(slider.low < 0) && !(slider.high > 0)) hold(model.slider(i));
  }
  if (model.spatial())
    for (const int edge : model.spinning_edges()) hold(model.angle(edge));
  if (model.weave().lattice)
    for (int c = 0; c < model.dimension(); ++c) hold(model.position(0) + c);
  return held;
}

}  // namespace supple::weave
