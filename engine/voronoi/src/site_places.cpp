#include "site_places.h"

#include <algorithm>
#include <string>
#include <utility>

#include "supple/base/error.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector3d;
using surface::TriangleMesh;

constexpr std::int64_t most_sites = 1'000'000;
/// Relative to the mean edge: sites closer than this are one.
constexpr double same_site = 1e-13;

}  // namespace

void check_site_count(std::int64_t count) {
  if (count < 1)
    throw Error("voronoi.no_sites", "A Voronoi diagram needs at least one site.",
                {{"sites", std::to_string(count) + " sites, the least is 1"}});
  if (count > most_sites)
    throw Error("voronoi.too_many_sites", "A Voronoi diagram has at most 1,000,000 sites.",
                {{"sites", std::to_string(count) + " sites, the limit is 1000000"}});
}

std::vector<std::int32_t> first_in_place(const TriangleMesh& mesh, std::span<const surface::SurfacePoint> sites) {
  std::vector<std::pair<Vector3d, std::int32_t>> places;
  for (std::size_t i = 0; i < sites.size(); ++i)
    places.emplace_back(surface::position(mesh, sites[i]), static_cast<std::int32_t>(i));
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) {
    return a.first.x() != b.first.x() ? a.first.x() < b.first.x() : a.second < b.second;
  });
  // Sheets may touch in space: sites in one place are in faces that share a vertex.
  const auto touch = [&](std::int32_t a, std::int32_t b) {
    const auto& of_a = mesh.faces()[static_cast<std::size_t>(index(sites[static_cast<std::size_t>(a)].face))];
    const auto& of_b = mesh.faces()[static_cast<std::size_t>(index(sites[static_cast<std::size_t>(b)].face))];
    return std::find_first_of(of_a.begin(), of_a.end(), of_b.begin(), of_b.end()) != of_a.end();
  };
  const double reach = same_site * mesh.mean_edge_length();
  std::vector<std::int32_t> first(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) first[i] = static_cast<std::int32_t>(i);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size() && places[j].first.x() - places[i].first.x() <= reach; ++j) {
      if ((places[j].first - places[i].first).norm() > reach || !touch(places[i].second, places[j].second)) continue;
      const std::int32_t a = first[static_cast<std::size_t>(places[i].second)];
      std::int32_t& b = first[static_cast<std::size_t>(places[j].second)];
      if (a < b)
        b = a;
      else
        first[static_cast<std::size_t>(places[i].second)] = b;
    }
  }
  return first;
}

}  // namespace supple::voronoi
