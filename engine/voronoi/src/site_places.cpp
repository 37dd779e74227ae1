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
/// Relative to the mean edge length: sites closer than this coincide.
constexpr double site_merge_distance = 1e-13;

struct Place {
  Vector3d position = Vector3d::Zero();
  std::int32_t site = -1;
};

/// The hash of a grid cell. Its coordinates are whole numbers, which may exceed the range of integers.
std::size_t cell_hash(const Vector3d& cell) {
  // Adding 0.0 turns minus zero into zero.
  const auto bits = [](double coordinate) { return std::bit_cast<std::uint64_t>(coordinate + 0.0); };
  return SeededHash::of(bits(cell.x()), bits(cell.y()), bits(cell.z()));
}

/// Finds for each of a run of sites, given in ascending order, the first one in its place.
class PlaceFinder {
 public:
  PlaceFinder(const TriangleMesh& mesh, std::span<const surface::SurfacePoint> sites, double tolerance,
              const CancellationToken& cancellation)
      : mesh_(mesh), sites_(sites), tolerance_(tolerance), pace_(cancellation) {}

  void find(std::span<const Place> run, std::vector<std::int32_t>& first) {
    if (run.size() <= max_pairwise) return find_pairwise(run, first);
    // Sites that are first in their places are put into the cells of a grid. Equal hashes of different cells cost only
    // time.
    cells_.clear();
    for (const Place& place : run) {
      const Vector3d cell = (place.position / tolerance_).array().floor();
      const std::int32_t before = first_near(place, cell);
      if (before < 0)
        cells_[cell_hash(cell)].push_back(place);
      else
        first[static_cast<std::size_t>(place.site)] = before;
    }
  }

 private:
  static constexpr std::size_t max_pairwise = 8;

  void find_pairwise(std::span<const Place> run, std::vector<std::int32_t>& first) {
    for (std::size_t i = 1; i < run.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (first[static_cast<std::size_t>(run[j].site)] != run[j].site || !coincide(run[i], run[j])) continue;
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
        if (coincide(place, other)) return other.site;
    }
    return -1;
  }

  bool coincide(const Place& a, const Place& b) {
    pace_.check();
    return (a.position - b.position).norm() <= tolerance_ && share_vertex(a.site, b.site);
  }

  /// Sites at one position coincide only if their faces share a vertex, because sheets of the surface may touch in
  /// space.
  bool share_vertex(std::int32_t a, std::int32_t b) const {
    const auto& of_a = mesh_.faces()[static_cast<std::size_t>(index(sites_[static_cast<std::size_t>(a)].face))];
    const auto& of_b = mesh_.faces()[static_cast<std::size_t>(index(sites_[static_cast<std::size_t>(b)].face))];
    return std::find_first_of(of_a.begin(), of_a.end(), of_b.begin(), of_b.end()) != of_a.end();
  }

  const TriangleMesh& mesh_;
  std::span<const surface::SurfacePoint> sites_;
  double tolerance_;
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
  const double tolerance = site_merge_distance * mesh.mean_edge_length();
  std::vector<Place> places(sites.size());
  std::vector<std::int32_t> first(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    first[i] = static_cast<std::int32_t>(i);
    places[i] = {surface::position(mesh, sites[i]), first[i]};
  }
  const auto x_of = [](const Place& place) { return place.position.x(); };
  sort_stoppably(places, cancellation, [&](const Place& a, const Place& b) { return x_of(a) < x_of(b); });
  // Most sites have no other one with nearly the same x, and are skipped.
  PlaceFinder finder(mesh, sites, tolerance, cancellation);
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    for (end = begin + 1; end < places.size() && x_of(places[end]) - x_of(places[end - 1]) <= tolerance;) ++end;
    if (end == begin + 1) continue;
    const std::span run(places.begin() + static_cast<std::ptrdiff_t>(begin), end - begin);
    sort_stoppably(run, cancellation, [](const Place& a, const Place& b) { return a.site < b.site; });
    finder.find(run, first);
  }
  return first;
}

}  // namespace supple::voronoi
