#include "constrained_points.h"

#include <algorithm>

namespace supple::embedded {

ConstrainedPoints constrained_points(const Network& network) {
  ConstrainedPoints points;
  std::vector<double>& stiffness = points.stiffness;
  stiffness.assign(network.points.size(), 0);
  for (const Spring& spring : network.springs) {
    stiffness[static_cast<std::size_t>(spring.from)] += 2 * spring.weight;
    stiffness[static_cast<std::size_t>(spring.to)] += 2 * spring.weight;
  }
  const double membrane = network.material.youngs_modulus * network.material.thickness;
  for (const MembraneTriangle& triangle : network.triangles) {
    for (const std::int32_t corner : triangle.corners) stiffness[static_cast<std::size_t>(corner)] += 2 * membrane;
  }
  points.fixed.resize(network.points.size(), false);
  for (const std::int32_t point : network.fixed_points) points.fixed[static_cast<std::size_t>(point)] = true;
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    points.max_stiffness = std::max(points.max_stiffness, stiffness[i]);
    if (stiffness[i] > 0 || points.fixed[i]) continue;
    points.fixed[i] = true;
    points.loose.push_back(static_cast<std::int32_t>(i));
  }
  return points;
}

std::vector<bool> fixed_coordinates(const std::vector<bool>& fixed_points) {
  std::vector<bool> coordinates(2 * fixed_points.size());
  for (std::size_t i = 0; i < fixed_points.size(); ++i) coordinates[2 * i] = coordinates[2 * i + 1] = fixed_points[i];
  return coordinates;
}

}  // namespace supple::embedded
