#include "cell_objective.h"

#include <algorithm>
#include <utility>

namespace supple::microscale {

CellObjective::CellObjective(CellModel& model, Eigen::VectorXd x, FreeStrains free, CostLedger* cost)
    : model_(model), x_(std::move(x)), free_(std::move(free)), cost_(cost), sum_(model.workspace().sum) {}

numerics::Evaluation CellObjective::evaluate(int order) {
  const Eigen::VectorXd& x = trial_.size() > 0 ? trial_ : x_;
  const Eigen::Index nodal = model_.coordinates().strain();
  const auto m = static_cast<Eigen::Index>(free_.size());
  if (order > evaluated_ || order >= 2) {
    // Most trial states are accepted, and their gradient costs little more than their value.
    const int made = std::max(order, 1);
    sum_.value = 0;
    sum_.gradient.setZero(x.size());
    if (order >= 2) sum_.hessian.clear();
    model_.add(x, made, sum_, cost_);
    evaluated_ = made;
  }

  numerics::Evaluation evaluation;
  evaluation.value = sum_.value;
  if (order >= 1) {
    evaluation.gradient.resize(nodal + m);
    evaluation.gradient.head(nodal) = sum_.gradient.head(nodal);
    evaluation.gradient.head<2>().setZero();
    for (Eigen::Index k = 0; k < m; ++k)
      evaluation.gradient[nodal + k] = free_[static_cast<std::size_t>(k)].dot(sum_.gradient.tail<4>());
  }
  if (order >= 2) {
    sum_.hessian.assemble(x.size(), *reduced_);
    hold_first_node(reduced_->core);
    border_.swap(reduced_->border);
    border_.topRows<2>().setZero();
    corner_ = reduced_->corner;
    reduced_->border.resize(nodal, m);
    reduced_->corner.resize(m, m);
    for (Eigen::Index k = 0; k < m; ++k) {
      const Eigen::Vector4d& direction = free_[static_cast<std::size_t>(k)];
      reduced_->border.col(k) = border_ * direction;
      for (Eigen::Index l = 0; l < m; ++l)
        reduced_->corner(k, l) = direction.dot(corner_ * free_[static_cast<std::size_t>(l)]);
    }
    evaluation.hessian = std::shared_ptr<const numerics::BorderedMatrix>(reduced_);
  }
  return evaluation;
}

double CellObjective::move(const Eigen::VectorXd& step) {
  forget();
  trial_ = model_.retract(x_, expand(step), cost_);
  const Eigen::VectorXd way = trial_ - x_;
  const double share = std::min(1.0, model_.prepare(x_, way, cost_));
  if (share < 1) trial_ = x_ + share * way;
  return share;
}

void CellObjective::reject() {
  trial_.resize(0);
  forget();
}

void CellObjective::accept() {
  x_ = std::move(trial_);
  trial_.resize(0);
}

Eigen::VectorXd CellObjective::expand(const Eigen::VectorXd& y) const {
  const Eigen::Index nodal = model_.coordinates().strain();
  Eigen::VectorXd x(nodal + 4);
  x.head(nodal) = y.head(nodal);
  x.tail<4>().setZero();
  for (std::size_t k = 0; k < free_.size(); ++k) x.tail<4>() += y[nodal + static_cast<Eigen::Index>(k)] * free_[k];
  return x;
}

void hold_first_node(numerics::SparseMatrix& lower) {
  // In the lower triangle every entry of the first unknowns stands in their columns.
  double scale = 0;
  for (Eigen::Index column = 0; column < 2; ++column) {
    const auto begin = lower.outerIndexPtr()[column];
    const auto end = lower.outerIndexPtr()[column + 1];
    if (scale == 0) scale = lower.valuePtr()[begin];
    std::fill(lower.valuePtr() + begin, lower.valuePtr() + end, 0.0);
    lower.valuePtr()[begin] = scale;
  }
}

}  // namespace supple::microscale
