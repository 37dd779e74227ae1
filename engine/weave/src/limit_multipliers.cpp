#include "limit_multipliers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::weave {
namespace {

/// Ratio of a limit's stiffness to that of its strand, EA / l. Each update divides the error by about this ratio.
constexpr double limit_stiffness_ratio = 1000;
/// Distance beyond an inactive limit from which it counts as crossed, relative to the mean length of rod. Smaller
/// distances are rounding.
constexpr double penetration_tolerance = 1e-10;
/// Maximum fraction of the remaining distance, until a limit is crossed by its barrier's range, that one step may use.
constexpr double max_step_fraction = 0.95;

}  // namespace

LimitMultipliers::LimitMultipliers(const RodModel& model, const SlidingLimits& limits, const CrossingContact& contact) {
  limits_.reserve(limits.limits().size() + contact.limits().size());
  for (const BarrierEnergy* barriers :
       {static_cast<const BarrierEnergy*>(&limits), static_cast<const BarrierEnergy*>(&contact)})
    for (const SlidingLimit& constraint : barriers->limits())
      limits_.push_back({barriers, &constraint,
                         limit_stiffness_ratio * model.stiffness(constraint.strand).stretch / mean_rod_length});
}

void LimitMultipliers::initialize(const Eigen::VectorXd& x) {
  for (Limit& limit : limits_) {
    limit.force = -limit.barriers->at(*limit.constraint, x).first;
    limit.active = limit.force > 0;
  }
}

bool LimitMultipliers::update(const Eigen::VectorXd& x) {
  bool active_set_changed = false;
  for (Limit& limit : limits_) {
    const double d = limit.constraint->distance(x);
    if (limit.active) {
      limit.force -= limit.stiffness * d;
      if (limit.force >= 0) continue;
      limit.force = 0;
      limit.active = false;
      active_set_changed = true;
    } else if (d < -penetration_tolerance * mean_rod_length) {
      limit.active = true;
      active_set_changed = true;
    }
  }
  return active_set_changed;
}

bool LimitMultipliers::all_inactive() const {
  return std::none_of(limits_.begin(), limits_.end(), [](const Limit& limit) { return limit.active; });
}

double LimitMultipliers::error(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Limit& limit : limits_)
    if (limit.active) sum += std::abs(limit.force * limit.constraint->distance(x));
  return sum;
}

double LimitMultipliers::value(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Limit& limit : limits_) {
    if (!limit.active) continue;
    const double d = limit.constraint->distance(x);
    sum += (0.5 * limit.stiffness * d - limit.force) * d;
  }
  return sum;
}

void LimitMultipliers::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  sum.value += value(x);
  if (order < 1) return;
  for (const Limit& limit : limits_) {
    if (!limit.active) continue;
    const Links& links = limit.constraint->links;
    const double slope = limit.stiffness * limit.constraint->distance(x) - limit.force;
    for (const Link& link : links) sum.gradient[link.dof] += link.coefficient * slope;
    if (order < 2) continue;
    for (auto one = links.begin(); one != links.end(); ++one)
      for (auto other = links.begin(); other <= one; ++other)
        sum.hessian.add(one->dof, other->dof, one->coefficient * other->coefficient * limit.stiffness);
  }
}

double LimitMultipliers::largest_step(const RodState& state, const Eigen::VectorXd& step) const {
  const Eigen::VectorXd& x = state.q();
  double max_step = std::numeric_limits<double>::infinity();
  for (const Limit& limit : limits_) {
    double rate = 0;
    for (const Link& link : limit.constraint->links) rate += link.coefficient * step[link.dof];
    if (rate < 0)
      max_step =
          std::min(max_step, max_step_fraction * (limit.constraint->distance(x) + limit.constraint->range) / -rate);
  }
  return max_step;
}

}  // namespace supple::weave
