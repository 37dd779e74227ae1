#include "supple/neural/model.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::neural {

std::optional<double> mean_stress_error(const Model& model) {
  if (!model.design_split) return std::nullopt;
  return model.design_split->gradient.mean;
}

std::vector<std::size_t> best_of_families(std::span<const Model* const> models) {
  const auto error = [&](std::size_t i) {
    return mean_stress_error(*models[i]).value_or(std::numeric_limits<double>::infinity());
  };
  std::vector<std::size_t> best;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const auto same = std::ranges::find_if(best, [&](std::size_t b) {
      return models[b]->family == models[i]->family && models[b]->definition == models[i]->definition;
    });
    if (same == best.end()) {
      best.push_back(i);
    } else if (error(i) < error(*same)) {
      *same = i;
    }
  }
  return best;
}

bool in_range(const Model& model, std::span<const double> parameters, const Eigen::Vector3d& strain,
              double energy_density, double rest_stiffness) {
  constexpr double rounding = 1e-9;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto i = static_cast<long>(k);
    const double slack = rounding * (model.network.upper[i] - model.network.lower[i]);
    if (!(parameters[k] >= model.network.lower[i] - slack && parameters[k] <= model.network.upper[i] + slack))
      return false;
  }
  const double middle = 0.5 * (strain[0] + strain[1]);
  const double radius = std::hypot(0.5 * (strain[0] - strain[1]), 0.5 * strain[2]);
  return middle - radius >= model.strain_range.smallest_principal - rounding &&
         middle + radius <= model.strain_range.largest_principal + rounding &&
         energy_density <= model.strain_range.largest_relative_energy * rest_stiffness;
}

}  // namespace supple::neural
