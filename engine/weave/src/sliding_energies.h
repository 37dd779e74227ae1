#pragma once

#include <vector>

#include "rod_elements.h"

namespace supple::weave {

/// b(d) = -k (d - r)^2 ln(d / r) for distances 0 < d < r (Li et al. 2020), 0 beyond: twice continuously differentiable,
/// infinite at 0. k in N/mm, distances in mm, b in N mm.
struct Barrier {
  double value = 0;
  double first = 0;
  double second = 0;
};
Barrier barrier(double distance, double range, double stiffness);

/// Distances that affine functions of the degrees of freedom keep above 0: d = offset + sum of coefficients times x.
class BarrierEnergy : public Energy {
 public:
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
  double largest_step(const RodState& state, const Eigen::VectorXd& step) const override;
  bool empty() const { return elements_.empty(); }
  /// How many distances are within their barrier's range at x.
  int near(const Eigen::VectorXd& x) const;

 protected:
  struct Element {
    double offset = 0;
    double range = 0;
    Links links;  ///< of the one slot 0
  };
  explicit BarrierEnergy(double stiffness) : stiffness_(stiffness) {}
  std::vector<Element> elements_;

 private:
  static double distance(const Element& element, const Eigen::VectorXd& x);
  double stiffness_;
};

/// Sliders end at their limits.
class SlidingLimits : public BarrierEnergy {
 public:
  /// `range`, mm: how far from a limit its barrier begins; a half of the slider's way to it at most.
  SlidingLimits(const RodModel& model, double range, double stiffness);
  std::string_view name() const override { return "sliding_limits"; }
};

/// Crossings of a strand, of which one at least slides, stay `least` mm of strand apart, or half as far as at rest
/// where that is less; from its ends they stay on it.
class CrossingContact : public BarrierEnergy {
 public:
  CrossingContact(const RodModel& model, double least, double range, double stiffness);
  std::string_view name() const override { return "crossing_contact"; }
};

/// E = k / 2 sum_j u_j^2 over the sliders' displacements u (mm), k in N/mm: a unique equilibrium where sliding is free.
class SlidingRegularizer : public Energy {
 public:
  SlidingRegularizer(const RodModel& model, double stiffness);
  std::string_view name() const override { return "sliding_regularizer"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;

 private:
  const RodModel& model_;
  double stiffness_;
};

/// E = -sum f . x: dead loads f (N, or N mm on angles) on degrees of freedom.
class PointForces : public Energy {
 public:
  struct Load {
    int dof = 0;
    double force = 0;
  };
  explicit PointForces(std::vector<Load> loads) : loads_(std::move(loads)) {}
  std::string_view name() const override { return "point_forces"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
  /// The forces act at this share of their size.
  void set_share(double share) { share_ = share; }

 private:
  std::vector<Load> loads_;
  double share_ = 1;
};

}  // namespace supple::weave
