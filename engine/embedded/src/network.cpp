#include "supple/embedded/network.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "supple/base/faults.h"

namespace supple::embedded {
namespace {

/// The checks that springs and triangles share.
class ElementCheck {
 public:
  ElementCheck(const surface::TriangleMesh& mesh, const Network& network, Faults& faults, Faults& unreachable)
      : mesh_(mesh), network_(network), faults_(faults), unreachable_(unreachable) {}

  /// Whether all points exist and are distinct. `where` is the path of their list in the request.
  bool points(std::span<const std::int32_t> points, const std::string& where) {
    const auto count = static_cast<std::int64_t>(network_.points.size());
    bool known = true;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (points[k] >= 0 && points[k] < count) continue;
      known = false;
      faults_.add(
          where + "/" + std::to_string(k),
          "is " + std::to_string(points[k]) + ", but points are numbered from 0 to " + std::to_string(count - 1));
    }
    for (std::size_t k = 0; k < points.size() && known; ++k)
      if (std::count(points.begin(), points.end(), points[k]) > 1) {
        faults_.add(where, "names one point twice");
        return false;
      }
    return known;
  }

  void component(std::span<const std::int32_t> points, const std::string& where) {
    const auto component_of = [&](std::int32_t point) {
      return mesh_.component(index(network_.points[static_cast<std::size_t>(point)].face));
    };
    for (const std::int32_t point : points)
      if (component_of(point) != component_of(points.front())) {
        unreachable_.add(where, "joins component " + std::to_string(component_of(points.front())) +
                                    " of the mesh to component " + std::to_string(component_of(point)));
        return;
      }
  }

  void nonnegative(double value, const std::string& where) {
    if (!std::isfinite(value))
      faults_.add(where, "is not finite");
    else if (value < 0)
      faults_.add(where, "is negative");
  }

 private:
  const surface::TriangleMesh& mesh_;
  const Network& network_;
  Faults& faults_;
  Faults& unreachable_;
};

void check_springs(const surface::TriangleMesh& mesh, const Network& network, Faults& unreachable) {
  Faults faults;
  ElementCheck check(mesh, network, faults, unreachable);
  for (std::size_t i = 0; i < network.springs.size(); ++i) {
    const Spring& spring = network.springs[i];
    const std::string where = "springs/" + std::to_string(i);
    const std::array<std::int32_t, 2> ends{spring.from, spring.to};
    const bool known = check.points(ends, where + "/between");
    check.nonnegative(spring.rest_length, where + "/rest_length");
    check.nonnegative(spring.weight, where + "/weight");
    if (known) check.component(ends, where + "/between");
  }
  faults.throw_if_any("network.spring");
}

/// Smallest height of a triangle at rest, as a fraction of its longest side.
constexpr double min_height = 1e-6;

void check_triangles(const surface::TriangleMesh& mesh, const Network& network, Faults& unreachable) {
  Faults faults;
  ElementCheck check(mesh, network, faults, unreachable);
  for (std::size_t i = 0; i < network.triangles.size(); ++i) {
    const MembraneTriangle& triangle = network.triangles[i];
    const std::string where = "triangles/" + std::to_string(i);
    if (check.points(triangle.corners, where)) check.component(triangle.corners, where);
    const auto& [a, b, c] = triangle.rest_lengths;
    if (!(a > 0 && b > 0 && c > 0 && std::isfinite(a + b + c))) {
      faults.add(where, "has rest lengths that are not positive and finite");
      continue;
    }
    // By Heron's formula, this is 16 times the squared area; it is negative if the sides form no triangle.
    const double longest = std::max({a, b, c});
    const double product = (a + b + c) * (b + c - a) * (a + c - b) * (a + b - c);
    if (!(product > 0 && std::sqrt(product) / 2 >= min_height * longest * longest))
      faults.add(where, "has rest lengths of a triangle without area");
  }
  faults.throw_if_any("network.triangle");
}

void check_material(const MembraneMaterial& material) {
  Faults faults;
  const auto positive = [&](double value, const std::string& where) {
    faults.require(value > 0 && std::isfinite(value), where, "must be positive and finite");
  };
  positive(material.youngs_modulus, "membrane/youngs_modulus");
  positive(material.thickness, "membrane/thickness");
  faults.require(material.poisson_ratio > -1 && material.poisson_ratio < 0.5, "membrane/poisson_ratio",
                 "must lie between -1 and 0.5, both excluded");
  faults.throw_if_any("network.membrane");
}

}  // namespace

double largest_weight(const Network& network) {
  double largest = network.triangles.empty() ? 0 : network.material.youngs_modulus * network.material.thickness;
  for (const Spring& spring : network.springs) largest = std::max(largest, spring.weight);
  return largest;
}

Network checked_network(const surface::TriangleMesh& mesh, Network network) {
  if (network.points.empty())
    throw Error("network.no_points", "A network needs at least one point.", {{"points", "is empty"}});
  for (std::size_t i = 0; i < network.points.size(); ++i)
    network.points[i] = surface::checked_point(mesh, network.points[i], "points/" + std::to_string(i));
  Faults unreachable;
  check_springs(mesh, network, unreachable);
  check_triangles(mesh, network, unreachable);
  if (!network.triangles.empty()) check_material(network.material);
  Faults fixed;
  const auto count = static_cast<std::int64_t>(network.points.size());
  for (std::size_t i = 0; i < network.fixed_points.size(); ++i) {
    const std::int32_t point = network.fixed_points[i];
    fixed.require(point >= 0 && point < count, "fixed_points/" + std::to_string(i),
                  "is " + std::to_string(point) + ", but points are numbered from 0 to " + std::to_string(count - 1));
  }
  fixed.throw_if_any("network.fixed_point");
  unreachable.throw_if_any("network.unreachable");
  return network;
}

}  // namespace supple::embedded
