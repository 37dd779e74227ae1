#pragma once

#include <optional>
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

/// A distance d = offset + sum of coefficients times the degrees of freedom x that may not fall below 0, mm.
struct SlidingLimit {
  int strand = 0;     ///< the strand that slides
  double offset = 0;  ///< distance at rest, mm
  double range = 0;   ///< distance at which the barrier begins, mm
  Links links{};      ///< of the one slot 0

  double distance(const Eigen::VectorXd& x) const {
    double d = offset;
    for (const Link& link : links) d += link.coefficient * x[link.dof];
    return d;
  }
};

/// Barriers before limits, which keep a path of equilibria clear of them. The stiffness of each is proportional to that
/// of its strand: `barrier_stretch` EA / l, where l is the mean length of rod between crossings.
class BarrierEnergy : public Energy {
 public:
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
  double largest_step(const RodState& state, const Eigen::VectorXd& step) const override;
  bool empty() const { return limits_.empty(); }
  const std::vector<SlidingLimit>& limits() const { return limits_; }
  /// The barrier of a limit at x. It pushes with the force -first, N.
  Barrier at(const SlidingLimit& limit, const Eigen::VectorXd& x) const;
  /// How many distances are within their barrier's range at x.
  int near(const Eigen::VectorXd& x) const;

 protected:
  explicit BarrierEnergy(const RodModel& model) : model_(model) {}
  std::vector<SlidingLimit> limits_;

 private:
  double stiffness(const SlidingLimit& limit) const;  ///< N/mm
  const RodModel& model_;
};

/// Sliders end at their limits.
class SlidingLimits : public BarrierEnergy {
 public:
  /// `range`, mm: how far from a limit its barrier begins; a half of the slider's way to it at most.
  SlidingLimits(const RodModel& model, double range);
  std::string_view name() const override { return "sliding_limits"; }
};

/// Crossings of a strand, of which one at least slides, stay `least` mm of strand apart, or half as far as at rest
/// where that is less. Without `least`, they stay so far apart that the strands that cross there touch. They stay half
/// as far from the strand's ends.
class CrossingContact : public BarrierEnergy {
 public:
  CrossingContact(const RodModel& model, const std::optional<double>& least, double range);
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
  /// The potential of the forces at x, N mm.
  double potential(const Eigen::VectorXd& x) const;
  /// The forces act at this share of their size.
  void set_share(double share) { share_ = share; }

 private:
  std::vector<Load> loads_;
  double share_ = 1;
};

}  // namespace supple::weave
