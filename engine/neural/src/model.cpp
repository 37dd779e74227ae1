#include "supple/neural/model.h"

#include <cmath>

namespace supple::neural {

std::optional<double> mean_stress_error(const Model& model) {
  if (!model.design_split) return std::nullopt;
  return model.design_split->gradient.mean;
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
