#include "limit_multipliers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::weave {
namespace {

/// Stiffness of a limit over that of its strand, EA / l: each update divides the error by about as much.
constexpr double limit_stretch = 1000;
/// An open limit counts as crossed from here on; below it lies rounding. Relative to the mean length of rod.
constexpr double crossed = 1e-10;
/// A step may use up this share of what is left before a distance becomes less than minus the barrier's range.
constexpr double share_of_free_way = 0.95;

}  // namespace

LimitMultipliers::LimitMultipliers(const RodModel& model, const SlidingLimits& limits, const CrossingContact& contact) {
  limits_.reserve(limits.limits().size() + contact.limits().size());
  for (const BarrierEnergy* barriers :
       {static_cast<const BarrierEnergy*>(&limits), static_cast<const BarrierEnergy*>(&contact)})
    for (const SlidingLimit& place : barriers->limits())
      limits_.push_back({barriers, &place, limit_stretch * model.stiffness(place.strand).stretch / mean_rod_length});
}

void LimitMultipliers::begin(const Eigen::VectorXd& x) {
  for (Limit& limit : limits_) {
    limit.force = -limit.barriers->at(*limit.place, x).first;
    limit.closed = limit.force > 0;
  }
}

bool LimitMultipliers::update(const Eigen::VectorXd& x) {
  bool changed = false;
  for (Limit& limit : limits_) {
    const double d = limit.place->distance(x);
    if (limit.closed) {
      limit.force -= limit.stiffness * d;
      if (limit.force >= 0) continue;
      limit.force = 0;
      limit.closed = false;
      changed = true;
    } else if (d < -crossed * mean_rod_length) {
      limit.closed = true;
      changed = true;
    }
  }
  return changed;
}

bool LimitMultipliers::all_open() const {
  return std::none_of(limits_.begin(), limits_.end(), [](const Limit& limit) { return limit.closed; });
}

double LimitMultipliers::error(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Limit& limit : limits_)
    if (limit.closed) sum += std::abs(limit.force * limit.place->distance(x));
  return sum;
}

double LimitMultipliers::value(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Limit& limit : limits_) {
    if (!limit.closed) continue;
    const double d = limit.place->distance(x);
    sum += (0.5 * limit.stiffness * d - limit.force) * d;
  }
  return sum;
}

void LimitMultipliers::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  sum.value += value(x);
  if (order < 1) return;
  for (const Limit& limit : limits_) {
    if (!limit.closed) continue;
    const Links& links = limit.place->links;
    const double slope = limit.stiffness * limit.place->distance(x) - limit.force;
    for (const Link& link : links) sum.gradient[link.dof] += link.coefficient * slope;
    if (order < 2) continue;
    for (auto one = links.begin(); one != links.end(); ++one)
      for (auto other = links.begin(); other <= one; ++other)
        sum.hessian.add(one->dof, other->dof, one->coefficient * other->coefficient * limit.stiffness);
  }
}

double LimitMultipliers::largest_step(const RodState& state, const Eigen::VectorXd& step) const {
  const Eigen::VectorXd& x = state.q();
  double largest = std::numeric_limits<double>::infinity();
  for (const Limit& limit : limits_) {
    double speed = 0;
    for (const Link& link : limit.place->links) speed += link.coefficient * step[link.dof];
    if (speed < 0)
      largest = std::min(largest, share_of_free_way * (limit.place->distance(x) + limit.place->range) / -speed);
  }
  return largest;
}

}  // namespace supple::weave
