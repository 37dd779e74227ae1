#include "sliding_energies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace supple::weave {
namespace {

/// A step may close this share of a distance: the barrier then still acts in the next one.
constexpr double share_of_way = 0.95;
/// A barrier begins no farther from its limit than this share of the way to it at rest.
constexpr double share_of_range = 0.5;

}  // namespace

Barrier barrier(double distance, double range, double stiffness) {
  if (!(distance > 0)) return {std::numeric_limits<double>::infinity(), 0, 0};
  if (distance >= range) return {};
  const double c = distance - range;
  const double log = std::log(distance / range);
  return {-stiffness * c * c * log, -stiffness * (2 * c * log + c * c / distance),
          -stiffness * (2 * log + 4 * c / distance - c * c / (distance * distance))};
}

double BarrierEnergy::distance(const Element& element, const Eigen::VectorXd& x) {
  double d = element.offset;
  for (const Link& link : element.links) d += link.coefficient * x[link.dof];
  return d;
}

void BarrierEnergy::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  for (const Element& element : elements_) {
    const Barrier b = barrier(distance(element, x), element.range, stiffness_);
    if (b.value == 0) continue;
    sum.value += b.value;
    if (order < 1) continue;
    for (const Link& link : element.links) sum.gradient[link.dof] += link.coefficient * b.first;
    if (order < 2) continue;
    for (auto one = element.links.begin(); one != element.links.end(); ++one)
      for (auto other = element.links.begin(); other <= one; ++other)
        sum.hessian.add(one->dof, other->dof, one->coefficient * other->coefficient * b.second);
  }
}

double BarrierEnergy::largest_step(const RodState& state, const Eigen::VectorXd& step) const {
  const Eigen::VectorXd& x = state.q();
  double largest = std::numeric_limits<double>::infinity();
  for (const Element& element : elements_) {
    double speed = 0;
    for (const Link& link : element.links) speed += link.coefficient * step[link.dof];
    if (speed < 0) largest = std::min(largest, share_of_way * distance(element, x) / -speed);
  }
  return largest;
}

int BarrierEnergy::near(const Eigen::VectorXd& x) const {
  return static_cast<int>(
      std::count_if(elements_.begin(), elements_.end(), [&](const Element& e) { return distance(e, x) < e.range; }));
}

SlidingLimits::SlidingLimits(const RodModel& model, double range, double stiffness) : BarrierEnergy(stiffness) {
  for (int i = 0; i < static_cast<int>(model.sliders().size()); ++i) {
    const Slider& slider = model.sliders()[static_cast<std::size_t>(i)];
    const int dof = model.slider(i);
    if (std::isfinite(slider.high) && slider.high > 0)
      elements_.push_back({slider.high, std::min(range, share_of_range * slider.high), {{dof, 0, -1}}});
    if (std::isfinite(slider.low) && slider.low < 0)
      elements_.push_back({-slider.low, std::min(range, share_of_range * -slider.low), {{dof, 0, 1}}});
  }
}

CrossingContact::CrossingContact(const RodModel& model, double least, double range, double stiffness)
    : BarrierEnergy(stiffness) {
  elements_.reserve(model.gaps().size());
  for (const Gap& gap : model.gaps()) {
    const double at_rest = gap.to.start - gap.from.start;
    const double kept = gap.at_end ? 0 : std::min(least, share_of_range * at_rest);
    Element element{at_rest - kept, std::min(range, share_of_range * (at_rest - kept)), {}};
    for (const auto& [place, sign] : {std::pair(&gap.to, 1.0), std::pair(&gap.from, -1.0)})
      if (place->slider[0] >= 0) element.links.push_back({model.slider(place->slider[0]), 0, sign});
    elements_.push_back(std::move(element));
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

void PointForces::add(const RodState& state, int order, numerics::EnergySum& sum) const {
  const Eigen::VectorXd& x = state.q();
  for (const Load& load : loads_) {
    sum.value -= share_ * load.force * x[load.dof];
    if (order >= 1) sum.gradient[load.dof] -= share_ * load.force;
  }
}

}  // namespace supple::weave
