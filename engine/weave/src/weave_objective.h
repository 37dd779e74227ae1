#pragma once

#include <memory>
#include <vector>

#include "chart.h"
#include "rod_energies.h"
#include "sliding_energies.h"
#include "supple/base/cost_ledger.h"
#include "supple/numerics/objective.h"

namespace supple::weave {

struct EnergyOptions {
  double barrier_range = 0.1;            ///< mm from a limit or a neighbour where its barrier begins
  double barrier_stiffness = 10;         ///< N/mm
  double least_distance = 0.5;           ///< mm of strand between neighbouring crossings that slide
  double sliding_regularization = 1e-6;  ///< N/mm
};

/// A weave's energy over its unknowns, and the state: all degrees of freedom q and, in space, the chart that they are
/// seen from. Derivatives are given in the chart at the state where they are asked for, so that every Newton step
/// starts from one without singularities.
class WeaveObjective : public numerics::Objective {
 public:
  /// `held` says of each degree of freedom whether it is prescribed. `model` outlives the objective; `cost`, if given,
  /// too: it is billed for every term. The chart is empty in the plane.
  WeaveObjective(const RodModel& model, Eigen::VectorXd q, Chart chart, const std::vector<bool>& held,
                 const EnergyOptions& options, std::vector<PointForces::Load> forces = {}, CostLedger* cost = nullptr);

  const RodModel& model() const { return model_; }
  const Eigen::VectorXd& q() const { return q_; }
  const Chart& chart() const { return chart_; }
  /// Sets held degrees of freedom (or any). Not while there is a trial state.
  void set_state(Eigen::VectorXd q, Chart chart);
  /// The same where the chart stays; q is seen from it.
  void set_q(Eigen::VectorXd q) { set_state(std::move(q), chart_); }
  void set_force_share(double share);
  bool has_forces() const { return forces_ != nullptr; }

  const Numbering& numbering() const { return numbering_; }
  /// All degrees of freedom for the unknowns' y; zero where held.
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const;
  Eigen::VectorXd restrict(const Eigen::VectorXd& q) const;
  /// Derivatives by all degrees of freedom at the current state; those by held ones are reactions. N, N mm.
  Eigen::VectorXd full_gradient();

  const std::vector<std::shared_ptr<const numerics::Energy>>& terms() const { return terms_; }
  const SlidingLimits* limits() const { return limits_.get(); }
  const CrossingContact* contact() const { return contact_.get(); }

  Eigen::Index dimension() const override { return unknowns_; }
  numerics::Evaluation evaluate(int order) override;
  double move(const Eigen::VectorXd& step) override;
  void accept() override;
  void reject() override;
  double largest_step(const Eigen::VectorXd& step) const override;

 private:
  void add_terms(int order);
  Eigen::VectorXd& state() { return has_trial_ ? trial_ : q_; }

  const RodModel& model_;
  Eigen::VectorXd q_;
  Eigen::VectorXd trial_;
  bool has_trial_ = false;
  Chart chart_;   ///< what the terms see
  Chart before_;  ///< that of the current state while the trial state has its own
  bool rebased_ = false;
  Numbering numbering_;
  Eigen::Index unknowns_ = 0;
  std::vector<std::shared_ptr<const numerics::Energy>> terms_;
  std::shared_ptr<const SlidingLimits> limits_;
  std::shared_ptr<const CrossingContact> contact_;
  std::shared_ptr<PointForces> forces_;
  CostLedger* cost_;
  numerics::EnergySum sum_;
  std::shared_ptr<numerics::BorderedMatrix> hessian_ = std::make_shared<numerics::BorderedMatrix>();
};

/// Unknowns of a model: none held. Pinned sliders (no way to go), the spin of straight strands that nothing holds and,
/// for a lattice, the first node's position are held.
std::vector<bool> free_but_for_gauges(const RodModel& model);

}  // namespace supple::weave
