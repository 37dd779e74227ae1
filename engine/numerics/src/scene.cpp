#include "supple/numerics/scene.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace supple::numerics {

Scene::Scene(Eigen::VectorXd x, std::vector<std::shared_ptr<const Energy>> terms, CostLedger* cost)
    : x_(std::move(x)), terms_(std::move(terms)), cost_(cost) {}

Evaluation Scene::evaluate(int order) {
  using Clock = std::chrono::steady_clock;
  const Eigen::VectorXd& x = trial_.size() > 0 ? trial_ : x_;
  sum_.value = 0;
  if (order >= 1) sum_.gradient.setZero(x.size());
  if (order >= 2) sum_.hessian.clear();
  for (const auto& term : terms_) {
    const auto start = Clock::now();
    term->add(x, order, sum_);
    if (cost_) {
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      cost_->add_effect(term->name(), true, "a term of the scene", 1, seconds);
    }
  }
  Evaluation evaluation;
  evaluation.value = sum_.value;
  if (order >= 1) evaluation.gradient = sum_.gradient;
  if (order >= 2) evaluation.hessian = sum_.hessian.matrix(x.size());
  return evaluation;
}

double Scene::move(const Eigen::VectorXd& step) {
  trial_ = x_ + step;
  return 1;
}

void Scene::accept() {
  x_ = std::move(trial_);
  trial_.resize(0);
}

void Scene::reject() { trial_.resize(0); }

double Scene::largest_step(const Eigen::VectorXd& step) const {
  double largest = std::numeric_limits<double>::infinity();
  for (const auto& term : terms_) largest = std::min(largest, term->largest_step(x_, step));
  return largest;
}

}  // namespace supple::numerics
