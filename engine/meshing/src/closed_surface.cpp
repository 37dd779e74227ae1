#include "closed_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "supple/base/error.h"

namespace supple::meshing {
namespace {

/// Number of faulty edges that an error names.
constexpr std::size_t max_named_edges = 20;

/// A triangle's side, with its ends in ascending order.
struct Side {
  std::int32_t low;
  std::int32_t high;
  bool ascends;  ///< the triangle runs from the low end to the high one
  std::int32_t face;

  bool same_edge(const Side& other) const { return low == other.low && high == other.high; }
};

std::vector<Side> sorted_sides(std::span<const SurfaceTriangle> faces) {
  std::vector<Side> sides;
  sides.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({faces[f][k], faces[f][(k + 1) % 3]});
      sides.push_back({low, high, low == faces[f][k], static_cast<std::int32_t>(f)});
    }
  std::ranges::sort(sides, [](const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.face < b.face;
  });
  return sides;
}

[[noreturn]] void throw_open(const std::vector<Side>& faulty) {
  std::vector<Error::Detail> details;
  for (std::size_t k = 0; k < std::min(faulty.size(), max_named_edges); ++k)
    details.push_back({"edge " + std::to_string(faulty[k].low) + " " + std::to_string(faulty[k].high),
                       "does not lie between two faces that agree about the inside"});
  throw Error("solid.open_surface",
              "The surface encloses no solid: " + std::to_string(faulty.size()) +
                  (faulty.size() == 1 ? " edge does" : " edges do") + " not lie between two faces.",
              std::move(details));
}

std::size_t root_of(std::vector<std::size_t>& parents, std::size_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

ClosedSurface::ClosedSurface(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces)
    : positions_(positions) {
  for (const SurfaceTriangle& face : faces)
    for (const std::int32_t vertex : face)
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= positions.size())
        throw std::invalid_argument("a face of the surface names no vertex");
  find_components(faces);
  find_solids();
}

void ClosedSurface::find_components(std::span<const SurfaceTriangle> faces) {
  const std::vector<Side> sides = sorted_sides(faces);
  std::vector<std::size_t> parents(faces.size());
  std::iota(parents.begin(), parents.end(), 0);
  std::vector<Side> faulty;
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].same_edge(sides[first])) ++end;
    if (end - first != 2 || sides[first].ascends == sides[first + 1].ascends) {
      faulty.push_back(sides[first]);
      continue;
    }
    parents[root_of(parents, static_cast<std::size_t>(sides[first].face))] =
        root_of(parents, static_cast<std::size_t>(sides[first + 1].face));
  }
  if (!faulty.empty()) throw_open(faulty);
  constexpr auto none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> numbers(faces.size(), none);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::size_t& component = numbers[root_of(parents, f)];
    if (component == none) {
      component = components_.size();
      components_.emplace_back();
    }
    components_[component].push_back(faces[f]);
  }
  for (const auto& component : components_) {
    const Eigen::Vector3d& origin = positions_[static_cast<std::size_t>(component.front()[0])];
    double volume = 0;
    for (const auto& [a, b, c] : component)
      volume += tetrahedron_volume(origin, positions_[static_cast<std::size_t>(a)],
                                   positions_[static_cast<std::size_t>(b)], positions_[static_cast<std::size_t>(c)]);
    volumes_.push_back(std::abs(volume));
  }
}

bool ClosedSurface::encloses(std::size_t component, const Eigen::Vector3d& point) const {
  Eigen::AlignedBox3d box;
  for (const SurfaceTriangle& face : components_[component])
    for (const std::int32_t vertex : face) box.extend(positions_[static_cast<std::size_t>(vertex)]);
  if (!box.contains(point)) return false;
  // Each term is half the solid angle of a triangle [vanOosterom1983].
  double half_angles = 0;
  for (const auto& [i, j, k] : components_[component]) {
    const Eigen::Vector3d a = positions_[static_cast<std::size_t>(i)] - point;
    const Eigen::Vector3d b = positions_[static_cast<std::size_t>(j)] - point;
    const Eigen::Vector3d c = positions_[static_cast<std::size_t>(k)] - point;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    half_angles += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(half_angles) > std::numbers::pi;
}

void ClosedSurface::find_solids() {
  const std::size_t count = components_.size();
  // For each component, those that enclose it.
  std::vector<std::vector<std::size_t>> enclosing(count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      if (i != j && encloses(j, positions_[static_cast<std::size_t>(components_[i].front()[0])]))
        enclosing[i].push_back(j);
  std::vector<std::size_t> solid_of(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (enclosing[i].size() % 2 != 0) continue;
    solid_of[i] = solids_.size();
    solids_.push_back({i});
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (enclosing[i].size() % 2 == 0) continue;
    // The innermost component that encloses this cavity.
    const std::size_t outer =
        *std::ranges::max_element(enclosing[i], {}, [&](std::size_t j) { return enclosing[j].size(); });
    if (enclosing[outer].size() % 2 == 0) solids_[solid_of[outer]].push_back(i);
  }
}

double ClosedSurface::volume(const Solid& solid) const {
  double volume = volumes_[solid.front()];
  for (std::size_t k = 1; k < solid.size(); ++k) volume -= volumes_[solid[k]];
  return volume;
}

}  // namespace supple::meshing
