#include "sliding_energies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supple::weave {
namespace {

/// Maximum fraction of a distance that one step may close. The barrier then still acts in the next step.
constexpr double max_closing_fraction = 0.95;
/// Upper limit of the range of a barrier, and of the distance that crossings must keep, as a fraction of the distance
/// at rest.
constexpr double max_range_fraction = 0.5;
/// Ratio of a barrier's stiffness to that of its strand, EA / l. It gives 10 N/mm for a strand of printed PLA with a
/// radius of 0.25 mm whose crossings are 4 mm apart.
constexpr double barrier_stiffness_ratio = 0.0582;

}  // namespace

Barrier barrier(double distance, double range, double stiffness) {
  if (!(distance > 0)) return {std::numeric_limits<double>::infinity(), 0, 0};
  if (distance >= range) return {};
  const double c = distance - range;
  const double log = std::log(distance / range);
  return {-stiffness * c * c * log, -stiffness * (2 * c * log + c * c / distance),
          -stiffness * (2 * log + 4 * c / distance - c * c / (distance * distance))};
}

double BarrierEnergy::stiffness(const SlidingLimit& limit) const {
  return barrier_stiffness_ratio * model_.stiffness(limit.strand).stretch / mean_rod_length;
}

Barrier BarrierEnergy::at(const SlidingLimit& limit, const Eigen::VectorXd& x) const {
  return barrier(limit.distance(x), limit.range, stiffness(limit));
}

void BarrierEnergy::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  for (const SlidingLimit& limit : limits_) {
    const Barrier b = at(limit, x);
    if (b.value == 0) continue;
    sum.value += b.value;
    if (order < 1) continue;
    for (const Link& link : limit.links) sum.gradient[link.dof] += link.coefficient * b.first;
    if (order < 2) continue;
    for (auto one = limit.links.begin(); one != limit.links.end(); ++one)
      for (auto other = limit.links.begin(); other <= one; ++other)
        sum.hessian.add(one->dof, other->dof, one->coefficient * other->coefficient * b.second);
  }
}

double BarrierEnergy::largest_step(const RodState& state, const Eigen::VectorXd& step) const {
  const Eigen::VectorXd& x = state.q();
  double max_step = std::numeric_limits<double>::infinity();
  for (const SlidingLimit& limit : limits_) {
    double rate = 0;
    for (const Link& link : limit.links) rate += link.coefficient * step[link.dof];
    if (rate < 0) max_step = std::min(max_step, max_closing_fraction * limit.distance(x) / -rate);
  }
  return max_step;
}

int BarrierEnergy::count_within_range(const Eigen::VectorXd& x) const {
  return static_cast<int>(
      std::count_if(limits_.begin(), limits_.end(), [&](const SlidingLimit& l) { return l.distance(x) < l.range; }));
}

SlidingLimits::SlidingLimits(const RodModel& model, double range) : BarrierEnergy(model) {
  for (int i = 0; i < static_cast<int>(model.sliders().size()); ++i) {
    const Slider& slider = model.sliders()[static_cast<std::size_t>(i)];
    const int dof = model.slider(i);
    if (std::isfinite(slider.max_displacement) && slider.max_displacement > 0)
      limits_.push_back({slider.strand,
                         slider.max_displacement,
                         std::min(range, max_range_fraction * slider.max_displacement),
                         {{dof, 0, -1}}});
    if (std::isfinite(slider.min_displacement) && slider.min_displacement < 0)
      limits_.push_back({slider.strand,
                         -slider.min_displacement,
                         std::min(range, max_range_fraction * -slider.min_displacement),
                         {{dof, 0, 1}}});
  }
}

CrossingContact::CrossingContact(const RodModel& model, const std::optional<double>& min_distance, double range)
    : BarrierEnergy(model) {
  limits_.reserve(model.gaps().size());
  for (const Gap& gap : model.gaps()) {
    const double at_rest = gap.to.start - gap.from.start;
    const double contact_distance = min_distance ? *min_distance * (gap.at_end ? 0.5 : 1) : gap.contact_distance;
    const double retained = std::min(contact_distance, max_range_fraction * at_rest);
    SlidingLimit limit{gap.strand, at_rest - retained, std::min(range, max_range_fraction * (at_rest - retained))};
    for (const auto& [place, sign] : {std::pair(&gap.to, 1.0), std::pair(&gap.from, -1.0)})
      if (place->slider[0] >= 0) limit.links.push_back({model.slider(place->slider[0]), 0, sign});
    limits_.push_back(std::move(limit));
  }
}

SlidingRegularizer::SlidingRegularizer(const RodModel& model, double stiffness)
    : model_(model), stiffness_(stiffness) {}

void SlidingRegularizer::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  for (int i = 0; i < static_cast<int>(model_.sliders().size()); ++i) {
    const int dof = model_.slider(i);
    sum.value += 0.5 * stiffness_ * x[dof] * x[dof];
    if (order >= 1) sum.gradient[dof] += stiffness_ * x[dof];
    if (order >= 2) sum.hessian.add(dof, dof, stiffness_);
  }
}

double PointForces::potential(const Eigen::VectorXd& x) const {
  double work = 0;
  for (const Load& load : loads_) work += load.force * x[load.dof];
  return -fraction_ * work;
}

void PointForces::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  sum.value += potential(state.q());
  if (order < 1) return;
  for (const Load& load : loads_) sum.gradient[load.dof] -= fraction_ * load.force;
}

}  // namespace supple::weave
