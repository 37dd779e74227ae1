#include "supple/design/beam_width_sensitivity.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <new>

#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/base/parallel_tasks.h"
#include "supple/design/material_bound.h"

namespace supple::design {
namespace {

using RestCompliance = std::optional<Compliance>;

RestCompliance compliance_of(const Eigen::Matrix3d& tangent) {
  if (!tangent.allFinite()) return std::nullopt;
  const Eigen::FullPivLU<Eigen::Matrix3d> factored(tangent);
  if (!factored.isInvertible()) return std::nullopt;
  return factored.inverse();
}

/// The profile at rest of a structure that is turned by the orientation: its initial modulus if the target is of
/// stress.
Eigen::VectorXd profile_at_rest(const SampledTarget& target, const Compliance& compliance, double orientation) {
  const bool is_stress = target.samples.task == Task::stress_strain;
  std::vector<double> directions = is_stress ? std::vector{target.samples.direction} : target.samples.x;
  for (double& direction : directions) direction -= orientation;
  return rest_profile(compliance, is_stress ? Task::stiffness : target.samples.task, directions);
}

std::optional<double> relative_change(const SampledTarget& target, const Eigen::VectorXd& nominal,
                                      const Eigen::VectorXd& changed) {
  const bool is_stress = target.samples.task == Task::stress_strain;
  const Eigen::VectorXd weights = is_stress ? Eigen::VectorXd::Ones(1) : target.weights;
  const double size = std::sqrt(weights.dot(nominal.cwiseAbs2()));
  const double change = std::sqrt(weights.dot((changed - nominal).cwiseAbs2()));
  const double relative = change / std::max(size, min_scale(target.samples.task));
  return std::isfinite(relative) ? std::optional(relative) : std::nullopt;
}

}  // namespace

std::vector<BeamWidthSensitivity> beam_width_sensitivity(const Design& design, const RestTangent& rest_tangent,
                                                         const Execution& execution) {
  constexpr std::array width_factors{1.0, 1 + beam_width_error, 1 - beam_width_error};
  std::array<RestCompliance, width_factors.size()> compliances;
  std::vector<BeamWidthSensitivity> sensitivities(design.profiles.size());
  try {
    parallel_tasks(static_cast<int>(width_factors.size()), execution, "beam_width", [&](int k, const Execution& inner) {
      const auto index = static_cast<std::size_t>(k);
      try {
        compliances[index] = compliance_of(rest_tangent(design.parameters, width_factors[index], inner));
      } catch (const Error&) {
        // There is no such structure.
      }
    });
  } catch (const Cancelled& stop) {
    // The design is answered without its sensitivity if time or memory has run out.
    if (!keeps_best(stop.reason())) throw;
    if (stop.reason() == StopReason::memory) execution.cancellation.resume(stop.reason());
    return sensitivities;
  } catch (const std::bad_alloc&) {
    execution.cancellation.resume(StopReason::memory);
    execution.cancellation.throw_if_requested();
    return sensitivities;
  }
  const auto& [nominal, wide, narrow] = compliances;
  if (!nominal) return sensitivities;
  for (std::size_t t = 0; t < sensitivities.size(); ++t) {
    const SampledTarget& target = design.profiles[t].target;
    const Eigen::VectorXd profile = profile_at_rest(target, *nominal, design.orientation);
    const auto change_to = [&](const RestCompliance& other) -> std::optional<double> {
      if (!other) return std::nullopt;
      return relative_change(target, profile, profile_at_rest(target, *other, design.orientation));
    };
    sensitivities[t] = {change_to(wide), change_to(narrow)};
  }
  return sensitivities;
}

}  // namespace supple::design
