#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "supple/base/cost_ledger.h"
#include "supple/numerics/energy.h"
#include "supple/numerics/objective.h"

namespace supple::numerics {

/// Degrees of freedom in a vector space and the terms they call for, as one objective: E(x) = sum of the terms.
class Scene : public Objective {
 public:
  /// `cost`, if given, outlives the scene and is billed for every term: how often it was evaluated and for how long.
  Scene(Eigen::VectorXd x, std::vector<std::shared_ptr<const Energy>> terms, CostLedger* cost = nullptr);

  /// The current state.
  const Eigen::VectorXd& x() const { return x_; }

  Eigen::Index dimension() const override { return x_.size(); }
  Evaluation evaluate(int order) override;
  double move(const Eigen::VectorXd& step) override;
  void accept() override;
  void reject() override;
  /// The least of the terms' largest steps.
  double largest_step(const Eigen::VectorXd& step) const override;

 private:
  Eigen::VectorXd x_;
  Eigen::VectorXd trial_;  ///< empty while there is no trial state
  std::vector<std::shared_ptr<const Energy>> terms_;
  CostLedger* cost_;
  EnergySum sum_;
};

}  // namespace supple::numerics
