#include "elastic_network.h"

#include <algorithm>
#include <map>
#include <utility>

namespace supple::embedded {

ElasticNetwork::ElasticNetwork(const Network& network, std::vector<bool> fixed)
    : springs_(network.springs),
      material_(network.material),
      springs_at_(network.points.size()),
      triangles_at_(network.points.size()),
      fixed_(std::move(fixed)) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> path_between;
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& spring = springs_[i];
    paths_.push_back({spring.from, spring.to});
    if (!network.triangles.empty()) path_between.try_emplace(std::minmax(spring.from, spring.to), i);
    if (spring.weight <= 0) continue;
    springs_at_[static_cast<std::size_t>(spring.from)].push_back(static_cast<std::int32_t>(i));
    springs_at_[static_cast<std::size_t>(spring.to)].push_back(static_cast<std::int32_t>(i));
  }
  for (const MembraneTriangle& given : network.triangles) {
    std::array<Side, 3> sides;
    for (int k = 0; k < 3; ++k) {
      int from = k;
      int to = (k + 1) % 3;
      const auto corner = [&](int c) { return given.corners[static_cast<std::size_t>(c)]; };
      const auto [entry, is_new] = path_between.try_emplace(std::minmax(corner(from), corner(to)), paths_.size());
      if (is_new) paths_.push_back({corner(from), corner(to)});
      if (paths_[entry->second].from != corner(from)) std::swap(from, to);
      sides[static_cast<std::size_t>(k)] = {entry->second, from, to};
    }
    add_triangle(given, sides);
  }
  for (std::size_t i = 0; i < fixed_.size(); ++i)
    if (!fixed_[i] && !(springs_at_[i].empty() && triangles_at_[i].empty())) free_.push_back(i);
}

void ElasticNetwork::add_triangle(const MembraneTriangle& given, const std::array<Side, 3>& sides) {
  for (const std::int32_t corner : given.corners)
    triangles_at_[static_cast<std::size_t>(corner)].push_back(static_cast<std::int32_t>(triangles_.size()));
  triangles_.push_back({given, sides, TriangleEnergy(given.rest_lengths, material_)});
}

double ElasticNetwork::stiffness_at(std::size_t point) const {
  double stiffness = 0;
  for (const std::int32_t s : springs_at_[point]) stiffness += 2 * springs_[static_cast<std::size_t>(s)].weight;
  return stiffness + material_.youngs_modulus * material_.thickness * static_cast<double>(triangles_at_[point].size());
}

Network ElasticNetwork::elements_of(std::size_t point, const std::vector<surface::SurfacePoint>& points) const {
  Network own;
  own.material = material_;
  std::map<std::int32_t, std::int32_t> numbers;
  const auto number_of = [&](std::int32_t other) {
    const auto [entry, is_new] = numbers.try_emplace(other, static_cast<std::int32_t>(own.points.size()));
    if (is_new) own.points.push_back(points[static_cast<std::size_t>(other)]);
    return entry->second;
  };
  number_of(static_cast<std::int32_t>(point));
  for (const std::int32_t s : springs_at_[point]) {
    Spring spring = springs_[static_cast<std::size_t>(s)];
    spring.from = number_of(spring.from);
    spring.to = number_of(spring.to);
    own.springs.push_back(spring);
  }
  for (const std::int32_t t : triangles_at_[point]) {
    MembraneTriangle triangle = triangles_[static_cast<std::size_t>(t)].given;
    for (std::int32_t& corner : triangle.corners) corner = number_of(corner);
    own.triangles.push_back(triangle);
  }
  return own;
}

double ElasticNetwork::spring_energy(const FoundPaths& found, std::size_t spring) const {
  const Spring& own = springs_[spring];
  const double length = found.geodesics[spring].coincident() ? 0 : found.length_of(spring);
  const double excess = length - own.rest_length;
  return own.weight * excess * excess;
}

Eigen::Vector3d ElasticNetwork::side_lengths(const FoundPaths& found, std::size_t triangle) const {
  Eigen::Vector3d lengths;
  for (int k = 0; k < 3; ++k)
    lengths[k] = found.length_of(triangles_[triangle].sides[static_cast<std::size_t>(k)].path);
  return lengths;
}

std::vector<double> ElasticNetwork::path_forces(const FoundPaths& found) const {
  std::vector<double> forces(paths_.size(), 0);
  for (std::size_t i = 0; i < springs_.size(); ++i)
    forces[i] = 2 * springs_[i].weight * (found.length_of(i) - springs_[i].rest_length);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const TriangleEnergy::Value energy = triangles_[t].energy.at(side_lengths(found, t));
    for (int k = 0; k < 3; ++k) forces[triangles_[t].sides[static_cast<std::size_t>(k)].path] += energy.first[k];
  }
  return forces;
}

std::vector<bool> ElasticNetwork::compressed_at_cut_loci(const FoundPaths& found) const {
  std::vector<bool> ends(fixed_.size(), false);
  const std::vector<double> forces = path_forces(found);
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    if (!(forces[i] < 0) || found.is_unique(i)) continue;
    for (const std::int32_t end : {paths_[i].from, paths_[i].to})
      if (!is_fixed(end)) ends[static_cast<std::size_t>(end)] = true;
  }
  return ends;
}

}  // namespace supple::embedded
