#include "site_places.h"

#include <algorithm>
#include <bit>
#include <string>
#include <unordered_map>

#include "supple/base/error.h"
#include "supple/base/seeded_hash.h"
#include "supple/base/stop_pace.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector3d;
using surface::TriangleMesh;

constexpr std::int64_t max_sites = 1'000'000;
/// Relative to the mean edge: sites closer than this are one.
constexpr double same_site = 1e-13;

struct Place {
  Vector3d position = Vector3d::Zero();
  std::int32_t site = -1;
};

/// The hash of a cell, whose coordinates are whole numbers that integers may be too short for.
std::size_t cell_hash(const Vector3d& cell) {
  // Minus zero is zero.
  const auto bits = [](double coordinate) { return std::bit_cast<std::uint64_t>(coordinate + 0.0); };
  return SeededHash::of(bits(cell.x()), bits(cell.y()), bits(cell.z()));
}

/// Finds for each of some sites, given in ascending order, the first one in its place.
class Places {
 public:
  Places(const TriangleMesh& mesh, std::span<const surface::SurfacePoint> sites, double reach,
         const CancellationToken& cancellation)
      : mesh_(mesh), sites_(sites), reach_(reach), pace_(cancellation) {}

  void find(std::span<const Place> run, std::vector<std::int32_t>& first) {
    if (run.size() <= few) return find_few(run, first);
    // Those that are first in their places, by the cells of a grid. Cells whose hashes are the same cost time alone.
    cells_.clear();
    for (const Place& place : run) {
      const Vector3d cell = (place.position / reach_).array().floor();
      const std::int32_t before = first_near(place, cell);
      if (before < 0)
        cells_[cell_hash(cell)].push_back(place);
      else
        first[static_cast<std::size_t>(place.site)] = before;
    }
  }

 private:
  static constexpr std::size_t few = 8;

  void find_few(std::span<const Place> run, std::vector<std::int32_t>& first) {
    for (std::size_t i = 1; i < run.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (first[static_cast<std::size_t>(run[j].site)] != run[j].site || !are_one(run[i], run[j])) continue;
        first[static_cast<std::size_t>(run[i].site)] = run[j].site;
        break;
      }
  }

  std::int32_t first_near(const Place& place, const Vector3d& cell) {
    for (int k = 0; k < 27; ++k) {
      const Eigen::Vector3i offset(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
      const auto found = cells_.find(cell_hash(cell + offset.cast<double>()));
      if (found == cells_.end()) continue;
      for (const Place& other : found->second)
        if (are_one(place, other)) return other.site;
    }
    return -1;
  }

  bool are_one(const Place& a, const Place& b) {
    pace_.look();
    return (a.position - b.position).norm() <= reach_ && touch(a.site, b.site);
  }

  /// Sheets may touch in space: sites in one place are in faces that share a vertex.
  bool touch(std::int32_t a, std::int32_t b) const {
    const auto& of_a = mesh_.faces()[static_cast<std::size_t>(index(sites_[static_cast<std::size_t>(a)].face))];
    const auto& of_b = mesh_.faces()[static_cast<std::size_t>(index(sites_[static_cast<std::size_t>(b)].face))];
    return std::find_first_of(of_a.begin(), of_a.end(), of_b.begin(), of_b.end()) != of_a.end();
  }

  const TriangleMesh& mesh_;
  std::span<const surface::SurfacePoint> sites_;
  double reach_;
  StopPace pace_;
  std::unordered_map<std::size_t, std::vector<Place>> cells_;
};

}  // namespace

void check_site_count(std::int64_t count) {
  if (count < 1)
    throw Error("voronoi.no_sites", "A Voronoi diagram needs at least one site.",
                {{"sites", std::to_string(count) + " sites, the least is 1"}});
  if (count > max_sites)
    throw Error("voronoi.too_many_sites", "A Voronoi diagram has at most 1,000,000 sites.",
                {{"sites", std::to_string(count) + " sites, the limit is 1000000"}});
}

std::vector<std::int32_t> first_in_place(const TriangleMesh& mesh, std::span<const surface::SurfacePoint> sites,
                                         const CancellationToken& cancellation) {
  const double reach = same_site * mesh.mean_edge_length();
  std::vector<Place> places(sites.size());
  std::vector<std::int32_t> first(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    first[i] = static_cast<std::int32_t>(i);
    places[i] = {surface::position(mesh, sites[i]), first[i]};
  }
  const auto x_of = [](const Place& place) { return place.position.x(); };
  sort_stoppably(places, cancellation, [&](const Place& a, const Place& b) { return x_of(a) < x_of(b); });
  // Most sites have no other one near their x.
  Places near(mesh, sites, reach, cancellation);
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    for (end = begin + 1; end < places.size() && x_of(places[end]) - x_of(places[end - 1]) <= reach;) ++end;
    if (end == begin + 1) continue;
    const std::span run(places.begin() + static_cast<std::ptrdiff_t>(begin), end - begin);
    sort_stoppably(run, cancellation, [](const Place& a, const Place& b) { return a.site < b.site; });
    near.find(run, first);
  }
  return first;
}

}  // namespace supple::voronoi
