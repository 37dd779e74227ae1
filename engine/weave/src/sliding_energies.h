#pragma once

#include <optional>
#include <vector>

#include "rod_elements.h"

namespace supple::weave {

/// The barrier b(d) = -k (d - r)^2 ln(d / r) for distances 0 < d < r, and 0 beyond [Li2020]. It is twice continuously
/// differentiable and infinite at 0. k in N/mm, distances in mm, b in N mm.
struct Barrier {
  double value = 0;
  double first = 0;
  double second = 0;
};
Barrier barrier(double distance, double range, double stiffness);

/// A constraint on sliding: a distance d = offset + sum of coefficients times the degrees of freedom x must not fall
/// below 0, mm.
struct SlidingLimit {
  int strand = 0;     ///< the strand that slides
  double offset = 0;  ///< distance at rest, mm
  double range = 0;   ///< distance at which the barrier begins, mm
  Links links{};      ///< the summands, all of slot 0

  double distance(const Eigen::VectorXd& x) const {
    double d = offset;
    for (const Link& link : links) d += link.coefficient * x[link.dof];
    return d;
  }
};

/// Barriers before limits. They keep a path of equilibria at a distance from the limits. The stiffness of each barrier
/// is proportional to the stretching stiffness of its strand: `barrier_stiffness_ratio` EA / l, where l is the mean
/// length of rod between crossings.
class BarrierEnergy : public Energy {
 public:
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;
  double largest_step(const RodState& state, const Eigen::VectorXd& step) const override;
  bool empty() const { return limits_.empty(); }
  const std::vector<SlidingLimit>& limits() const { return limits_; }
  /// The barrier of a limit at x. Its force on the slider is -first, N.
  Barrier at(const SlidingLimit& limit, const Eigen::VectorXd& x) const;
  /// Number of distances at x that are within their barrier's range.
  int count_within_range(const Eigen::VectorXd& x) const;

 protected:
  explicit BarrierEnergy(const RodModel& model) : model_(model) {}
  std::vector<SlidingLimit> limits_;

 private:
  double stiffness(const SlidingLimit& limit) const;  ///< N/mm
  const RodModel& model_;
};

/// Barriers before the limits of the sliders' displacements.
class SlidingLimits : public BarrierEnergy {
 public:
  /// `range` is the distance in mm from a limit at which its barrier begins. It is at most half of the slider's
  /// distance from the limit at rest.
  SlidingLimits(const RodModel& model, double range);
  std::string_view name() const override { return "sliding_limits"; }
};

/// Barriers that keep neighbouring crossings of a strand, of which at least one slides, apart. The minimum distance
/// along the strand is `min_distance` (mm), or by default the one at which the strands that cross there touch. It is at
/// most half of the distance at rest. From the strand's ends it is half as large.
class CrossingContact : public BarrierEnergy {
 public:
  CrossingContact(const RodModel& model, const std::optional<double>& min_distance, double range);
  std::string_view name() const override { return "crossing_contact"; }
};

/// E = k / 2 sum_j u_j^2 over the sliders' displacements u (mm), k in N/mm. It makes the equilibrium unique where
/// sliding is free.
class SlidingRegularizer : public Energy {
 public:
  SlidingRegularizer(const RodModel& model, double stiffness);
  std::string_view name() const override { return "sliding_regularizer"; }
  void add(const RodState& state, int order, numerics::EnergySum& sum) const override;

 private:
  const RodModel& model_;
  double stiffness_;
};

/// E = -sum f x: dead loads f (N, or N mm on angles) on degrees of freedom x.
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
  /// Sets the fraction of their full size at which the forces act.
  void set_fraction(double fraction) { fraction_ = fraction; }

 private:
  std::vector<Load> loads_;
  double fraction_ = 1;
};

}  // namespace supple::weave
