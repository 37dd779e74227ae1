#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <utility>

namespace supple::testing {

/// Expects that every edge in a binary STL file belongs to exactly two triangles, which have it in opposite directions.
/// Returns the enclosed volume.
inline double volume_of_closed_stl(const std::string& stl) {
  using Vertex = std::array<float, 3>;
  std::uint32_t count = 0;
  std::memcpy(&count, stl.data() + 80, sizeof count);
  EXPECT_EQ(stl.size(), 84 + 50 * static_cast<std::size_t>(count));
  std::map<std::pair<Vertex, Vertex>, int> edges;
  double volume = 0;
  for (std::uint32_t t = 0; t < count; ++t) {
    std::array<Vertex, 3> corners;
    std::memcpy(corners.data(), stl.data() + 84 + 50 * static_cast<std::size_t>(t) + 12, sizeof corners);
    for (std::size_t k = 0; k < 3; ++k) ++edges[{corners[k], corners[(k + 1) % 3]}];
    const auto vector = [](const Vertex& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
    volume += vector(corners[0]).dot(vector(corners[1]).cross(vector(corners[2]))) / 6;
  }
  for (const auto& [edge, uses] : edges) {
    const auto opposite = edges.find({edge.second, edge.first});
    if (uses != 1 || opposite == edges.end() || opposite->second != 1) {
      ADD_FAILURE() << "the surface is not a closed manifold";
      break;
    }
  }
  return volume;
}

}  // namespace supple::testing
