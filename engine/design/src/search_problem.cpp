#include "search_problem.h"

#include <algorithm>

namespace supple::design {
namespace {

/// Default number of starting points in a single space.
constexpr int default_starts = 24;

}  // namespace

SearchProblem::SearchProblem(const DesignSpace& its_space, const DesignProblem& its_problem,
                             const DesignOptions& its_options, const ModulusChoice& its_materials)
    : space(its_space),
      problem(its_problem),
      options(its_options),
      materials(its_materials),
      bounds(space, problem),
      moduli(problem.moduli, space.model.provenance.youngs_modulus),
      limits(space, problem.limits) {
  targets.reserve(problem.targets.size());
  weights.reserve(problem.targets.size());
  for (const auto& target : problem.targets) {
    targets.push_back(sample_target(target));
    weights.push_back(target.weight);
    // Adding a correction to the model's values is the same as subtracting it from the target.
    if (!problem.corrections.empty())
      targets.back().y -= factor_for(target.task, moduli.single().value()) * problem.corrections[targets.size() - 1];
  }
}

TargetResiduals SearchProblem::exact_residuals() const {
  TargetResiduals residuals(space.evaluator, targets, weights, bounds.fixed_values, bounds.free,
                            options.equilibrium_tolerance, bounds.free.empty() ? Buildable{} : space.buildable);
  residuals.choose_among(moduli);
  return residuals;
}

TargetResiduals SearchProblem::search_residuals(const std::vector<SampledTarget>& at_targets,
                                                double equilibrium_tolerance, double outlier_threshold) const {
  TargetResiduals residuals(space.evaluator, at_targets, weights, bounds.fixed_values, bounds.free,
                            equilibrium_tolerance, space.buildable, outlier_threshold);
  residuals.choose_among(moduli);
  residuals.add_limits(limits);
  return residuals;
}

Eigen::VectorXd SearchProblem::requested_start() const {
  return FreeParameters::all_of(*problem.initial,
                                problem.initial_orientation.value_or(orientation_in(bounds.fixed_values)));
}

bool SearchProblem::is_near_any(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& point,
                                double distance) const {
  const neural::Network& network = space.model.network;
  const double orientation_range = orientation_in(bounds.upper) - orientation_in(bounds.lower);
  const Eigen::VectorXd width =
      FreeParameters::all_of(network.upper - network.lower, orientation_range > 0 ? orientation_range : 1);
  return std::any_of(points.begin(), points.end(), [&](const Eigen::VectorXd& other) {
    return (point - other).cwiseQuotient(width).cwiseAbs().maxCoeff() < distance;
  });
}

bool SearchProblem::has_many_samples() const {
  return std::any_of(targets.begin(), targets.end(),
                     [](const SampledTarget& target) { return target.y.size() > 2 * coarse_samples; });
}

int SearchProblem::max_starts() const { return options.starts > 0 ? options.starts : default_starts; }

bool SearchProblem::weighs_trust() const {
  return options.trust == Switch::on || (options.trust == Switch::automatic && !problem.initial);
}

}  // namespace supple::design
