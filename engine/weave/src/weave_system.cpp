#include "weave_system.h"

#include <utility>

namespace supple::weave {

WeaveSystem::Parts WeaveSystem::parts(const RodModel& model, const EnergyOptions& options,
                                      std::vector<PointForces::Load> forces) {
  Parts parts;
  parts.all.push_back(std::make_shared<StretchEnergy>(model));
  const bool jointed = model.joints() > 0;
  for (const TurnKind kind : {TurnKind::free, TurnKind::jointed}) {
    if (kind == TurnKind::jointed && !jointed) continue;
    if (model.spatial()) {
      parts.all.push_back(std::make_shared<SpatialBendEnergy>(model, kind));
      parts.all.push_back(std::make_shared<TwistEnergy>(model, kind));
    } else {
      parts.all.push_back(std::make_shared<PlanarBendEnergy>(model, kind));
    }
  }
  if (!model.sliders().empty()) {
    parts.limits = std::make_shared<SlidingLimits>(model, options.barrier_range);
    parts.contact = std::make_shared<CrossingContact>(model, options.least_distance, options.barrier_range);
    if (!parts.limits->empty()) parts.all.push_back(parts.limits);
    if (!parts.contact->empty()) parts.all.push_back(parts.contact);
    parts.all.push_back(std::make_shared<SlidingRegularizer>(model, options.sliding_regularization));
  }
  if (!forces.empty()) {
    parts.forces = std::make_shared<PointForces>(std::move(forces));
    parts.all.push_back(parts.forces);
  }
  return parts;
}

WeaveSystem::WeaveSystem(const RodModel& model, RodState state, const std::vector<bool>& fixed, Parts parts,
                         const Execution& execution)
    : System(std::move(state), parts.all, numerics::Unknowns(fixed),
             {.execution = {execution.cancellation, nullptr, execution.cost}}),
      model_(&model),
      parts_(std::move(parts)),
      fixed_(fixed),
      execution_(execution) {}

WeaveSystem::WeaveSystem(const RodModel& model, Eigen::VectorXd q, Chart chart, const std::vector<bool>& fixed,
                         const EnergyOptions& options, std::vector<PointForces::Load> forces,
                         const Execution& execution)
    : WeaveSystem(model, RodState(model, std::move(q), std::move(chart)), fixed,
                  parts(model, options, std::move(forces)), execution) {}

WeaveSystem WeaveSystem::with_rigid_limits() const {
  Parts rigid = parts_;
  rigid.multipliers = std::make_shared<LimitMultipliers>(*model_, *parts_.limits, *parts_.contact);
  std::erase_if(rigid.all, [&](const auto& term) { return term == parts_.limits || term == parts_.contact; });
  rigid.all.push_back(rigid.multipliers);
  return {*model_, state(), fixed_, std::move(rigid), execution_};
}

void WeaveSystem::set_state(Eigen::VectorXd q, Chart chart) {
  RodState state(*model_, std::move(q), std::move(chart));
  state.take_frame();
  System::set_state(std::move(state));
}

void WeaveSystem::set_force_fraction(double fraction) {
  if (!parts_.forces) return;
  parts_.forces->set_fraction(fraction);
  forget();
}

double WeaveSystem::stored_energy() {
  double stored = evaluate(0).value;
  if (parts_.forces) stored -= parts_.forces->potential(q());
  if (parts_.multipliers) stored -= parts_.multipliers->value(q());
  return stored;
}

std::vector<bool> gauge_constraints(const RodModel& model) {
  std::vector<bool> fixed(static_cast<std::size_t>(model.size()), false);
  const auto fix = [&fixed](int dof) { fixed[static_cast<std::size_t>(dof)] = true; };
  for (int i = 0; i < static_cast<int>(model.sliders().size()); ++i) {
    const Slider& slider = model.sliders()[static_cast<std::size_t>(i)];
    if (!(slider.min_displacement < 0) && !(slider.max_displacement > 0)) fix(model.slider(i));
  }
  if (model.spatial())
    for (const int edge : model.spinning_edges()) fix(model.angle(edge));
  if (model.weave().lattice)
    for (int c = 0; c < model.dimension(); ++c) fix(model.position(0) + c);
  return fixed;
}

}  // namespace supple::weave
