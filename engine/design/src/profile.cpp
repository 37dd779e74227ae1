#include "supple/design/profile.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "profile_trust.h"
#include "sampled_profile.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"

namespace supple::design {
namespace {

/// The range of Green strains that the service accepts. At -0.5 lengths vanish.
constexpr double min_green_strain = -0.5;
constexpr double max_green_strain = 7.5;

/// d C / d p: the change of the tangent C along a change of strain, from the energy's third derivatives.
Eigen::Matrix3d tangent_change(const Eigen::Ref<const Eigen::VectorXd>& third, const Eigen::Vector3d& change) {
  const auto t = [&third](int i) { return third[i]; };
  // The third derivatives are in the order 111, 112, 113, 122, 123, 133, 222, 223, 233, 333.
  Eigen::Matrix<double, 6, 1> c;
  c << t(0) * change[0] + t(1) * change[1] + t(2) * change[2], t(1) * change[0] + t(3) * change[1] + t(4) * change[2],
      t(2) * change[0] + t(4) * change[1] + t(5) * change[2], t(3) * change[0] + t(6) * change[1] + t(7) * change[2],
      t(4) * change[0] + t(7) * change[1] + t(8) * change[2], t(5) * change[0] + t(8) * change[1] + t(9) * change[2];
  return neural::symmetric_matrix(c);
}

double directional_value(Task task, const neural::UniaxialFrame& frame, const Eigen::Vector3d& stress,
                         const Eigen::Matrix3d& tangent) {
  if (task == Task::stress_strain) return frame.directional(stress);
  const auto path = path_rates(frame, tangent);
  if (task == Task::poisson) return -path.rates[0];
  return frame.along.dot(tangent * path.strain_rate);
}

double stretch(double green_strain) { return std::sqrt(1 + 2 * green_strain); }

double factor_of(Task task, StrainMeasure measure, double green_strain) {
  // F d = s d' with |d'| = 1 and S = sigma d d^T give the first Piola-Kirchhoff stress P d = F S d = s sigma d'. The
  // factor is therefore the stretch s.
  return task == Task::stress_strain && measure == StrainMeasure::engineering ? stretch(green_strain) : 1;
}

}  // namespace

std::string_view to_string(Task task) {
  switch (task) {
    case Task::stiffness:
      return "stiffness";
    case Task::poisson:
      return "poisson";
    default:
      return "stress_strain";
  }
}

std::string_view to_string(StrainMeasure measure) { return measure == StrainMeasure::green ? "green" : "engineering"; }

std::pair<double, double> strain_limits(StrainMeasure measure) {
  if (measure == StrainMeasure::green) return {min_green_strain, max_green_strain};
  return {stretch(min_green_strain) - 1, stretch(max_green_strain) - 1};
}

double green_strain(double strain, StrainMeasure measure) {
  return measure == StrainMeasure::green ? strain : strain + 0.5 * strain * strain;
}

std::vector<Sample> samples_of(const ProfileSamples& samples) {
  const auto [min_strain, max_strain] = strain_limits(samples.measure);
  const auto check = [&, low = min_strain, high = max_strain](double strain, const std::string& where) {
    if (strain > low && strain <= high) return;
    const std::string limits = "above " + number_text(low) + " and at most " + number_text(high);
    throw Error("model.invalid_load", "A strain along the load must be " + limits + ".",
                {{where, "must be " + limits + ", got " + number_text(strain)}});
  };
  std::vector<Sample> result(samples.x.size());
  const bool over_strain = samples.task == Task::stress_strain;
  if (!over_strain) check(samples.strain, "strain");
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (over_strain) check(samples.x[i], "x/" + std::to_string(i));
    const double strain = green_strain(over_strain ? samples.x[i] : samples.strain, samples.measure);
    result[i] = {samples.task,
                 {(over_strain ? samples.direction : samples.x[i]) - samples.orientation, strain},
                 factor_of(samples.task, samples.measure, strain)};
  }
  return result;
}

std::vector<Loading> loadings_of(const std::vector<Sample>& samples) {
  std::vector<Loading> loadings;
  loadings.reserve(samples.size());
  for (const auto& sample : samples) loadings.push_back(sample.loading);
  return loadings;
}

PathRates path_rates(const neural::UniaxialFrame& frame, const Eigen::Matrix3d& tangent) {
  const Eigen::Matrix2d h = frame.free.transpose() * tangent * frame.free;
  const Eigen::Vector2d rates = -neural::convex_solve(h, frame.free.transpose() * tangent * frame.along);
  return {rates, frame.strain(1, rates)};
}

double value_of(const Sample& sample, const neural::UniaxialFrame& frame, const Equilibrium& state) {
  if (sample.task != Task::stress_strain) return directional_value(sample.task, frame, state.stress, state.tangent);
  return sample.factor * path_rates(frame, state.tangent).strain_rate.dot(state.stress);
}

namespace {

/// Derivative of a state's strain by the direction of its load.
template <class Real>
Eigen::Vector3d strain_by_direction(const Sample& sample, const neural::UniaxialFrame& frame,
                                    const Equilibria<Real>& equilibria, std::size_t i) {
  return frame.slope().strain(sample.loading.strain, equilibria.free_strains(i)) +
         frame.free * equilibria.direction_sensitivity(i);
}

}  // namespace

template <class Real>
void ValueDerivatives<Real>::evaluate(const Evaluator& evaluator, const typename Evaluator::Design& design,
                                      const std::vector<Sample>& samples, const Equilibria<Real>& equilibria,
                                      Eigen::MatrixXd& derivatives, bool by_orientation) {
  const Eigen::Index parameters = evaluator.shape().parameters;
  derivatives.resize(static_cast<Eigen::Index>(samples.size()), parameters + (by_orientation ? 1 : 0));
  std::vector<std::size_t> with_tangents;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (samples[i].task != Task::stress_strain) with_tangents.push_back(i);
  if (!with_tangents.empty()) {
    Eigen::Matrix3Xd strains(3, static_cast<Eigen::Index>(with_tangents.size()));
    for (std::size_t k = 0; k < with_tangents.size(); ++k)
      strains.col(static_cast<Eigen::Index>(k)) = equilibria[with_tangents[k]].strain;
    evaluator.evaluate(design, strains, neural::Order::third, workspace_, evaluation_);
  }
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Equilibrium& state = equilibria[i];
    const auto& frame = equilibria.frame(i);
    const auto path = path_rates(frame, state.tangent);
    if (samples[i].task == Task::stress_strain) {
      // The strain rate is conjugate to the free strains: free^T C strain_rate = 0. Their changes contribute nothing.
      derivatives.row(row).head(parameters) =
          samples[i].factor * path.strain_rate.transpose() * state.stress_by_parameters;
      if (by_orientation) {
        const auto slope = frame.slope();
        const Eigen::Vector3d change = strain_by_direction(samples[i], frame, equilibria, i);
        derivatives(row, parameters) =
            -samples[i].factor * (slope.along.dot(state.stress) + frame.along.dot(state.tangent * change));
      }
      continue;
    }
    if (by_orientation) {
      const auto slope = frame.slope();
      const Eigen::Matrix3d change =
          tangent_change(evaluation_.third.col(column), strain_by_direction(samples[i], frame, equilibria, i));
      const Eigen::Vector3d rate_change = slope.strain(1, path.rates);
      if (samples[i].task == Task::stiffness) {
        // The rates minimize the stiffness, so that their change contributes nothing to first order.
        derivatives(row, parameters) =
            -path.strain_rate.dot(change * path.strain_rate + 2 * state.tangent * rate_change);
      } else {
        const Eigen::Matrix2d h = frame.free.transpose() * state.tangent * frame.free;
        derivatives(row, parameters) = -neural::convex_solve(
            h, slope.free.transpose() * state.tangent * path.strain_rate +
                   frame.free.transpose() * (change * path.strain_rate + state.tangent * rate_change))[0];
      }
    }
    const Eigen::Matrix2Xd free_changes = equilibria.sensitivity(i);
    for (Eigen::Index p = 0; p < parameters; ++p) {
      Eigen::Matrix<double, 6, 1> by_parameter;
      for (Eigen::Index c = 0; c < 6; ++c)
        by_parameter[c] = evaluation_.tangent_by_parameters(c * parameters + p, column);
      const Eigen::Matrix3d change = neural::symmetric_matrix(by_parameter) +
                                     tangent_change(evaluation_.third.col(column), frame.free * free_changes.col(p));
      if (samples[i].task == Task::stiffness) {
        derivatives(row, p) = path.strain_rate.dot(change * path.strain_rate);
      } else {
        const Eigen::Matrix2d h = frame.free.transpose() * state.tangent * frame.free;
        derivatives(row, p) = neural::convex_solve(h, frame.free.transpose() * change * path.strain_rate)[0];
      }
    }
    ++column;
  }
}

template class ValueDerivatives<double>;

double profile_value(Task task, StrainMeasure measure, double direction, double strain, const Eigen::Vector3d& stress,
                     const Eigen::Matrix3d& tangent) {
  return factor_of(task, measure, strain) * directional_value(task, neural::UniaxialFrame(direction), stress, tangent);
}

Profile evaluate_profile(const neural::Model& model, const neural::Evaluator& evaluator,
                         std::span<const double> parameters, const ProfileSamples& samples,
                         double equilibrium_tolerance, const Execution& execution) {
  const auto points = samples_of(samples);
  const auto design = evaluator.design(parameters);
  execution.checkpoint(0, "equilibria");
  const StageTimer timer(execution.cost, "equilibria");
  Equilibria<double> equilibria(evaluator, loadings_of(points), {.tolerance = equilibrium_tolerance});
  equilibria.set_cancellation(execution.cancellation);
  equilibria.from_rest(design);
  Profile profile;
  profile.y.resize(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Equilibrium& state = equilibria[i];
    double& y = profile.y[static_cast<Eigen::Index>(i)];
    y = std::numeric_limits<double>::quiet_NaN();
    if (!state.converged) continue;
    y = value_of(points[i], equilibria.frame(i), state);
    profile.residual = std::max(profile.residual, state.residual);
  }
  const neural::ErrorBars bars(model, evaluator, design, parameters, true);
  auto trust = profile_trust(model, bars, points, equilibria, 0, profile.y);
  profile.in_range = std::move(trust.in_range);
  profile.error_bar = std::move(trust.error_bar);
  if (execution.cost) execution.cost->add_quantity("evaluations", static_cast<double>(equilibria.evaluations()));
  return profile;
}

Profile scaled(Profile profile, Task task, double factor) {
  if (task == Task::poisson) return profile;
  profile.y *= factor;
  profile.error_bar *= factor;
  return profile;
}

}  // namespace supple::design
