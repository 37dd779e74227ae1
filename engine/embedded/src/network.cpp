#include "supple/embedded/network.h"

#include <cmath>
#include <string>

#include "supple/base/faults.h"

namespace supple::embedded {
namespace {

void check_spring(const surface::TriangleMesh& mesh, const Network& network, std::size_t i, Faults& faults,
                  Faults& unreachable) {
  const Spring& spring = network.springs[i];
  const std::string where = "springs/" + std::to_string(i);
  const auto count = static_cast<std::int64_t>(network.points.size());
  bool known = true;
  const auto check_end = [&](std::int32_t end, const std::string& at) {
    if (end >= 0 && end < count) return;
    known = false;
    faults.add(where + at,
               "is " + std::to_string(end) + ", but points are numbered from 0 to " + std::to_string(count - 1));
  };
  check_end(spring.from, "/between/0");
  check_end(spring.to, "/between/1");
  if (known && spring.from == spring.to) faults.add(where + "/between", "names one point twice");
  const auto check_size = [&](double value, const std::string& at) {
    if (!std::isfinite(value))
      faults.add(where + at, "is not finite");
    else if (value < 0)
      faults.add(where + at, "is negative");
  };
  check_size(spring.rest_length, "/rest_length");
  check_size(spring.weight, "/weight");
  if (!known) return;
  const auto component_of = [&](std::int32_t end) {
    return mesh.component(index(network.points[static_cast<std::size_t>(end)].face));
  };
  if (component_of(spring.from) != component_of(spring.to))
    unreachable.add(where + "/between", "joins component " + std::to_string(component_of(spring.from)) +
                                            " of the mesh to component " + std::to_string(component_of(spring.to)));
}

}  // namespace

Network checked_network(const surface::TriangleMesh& mesh, Network network) {
  if (network.points.empty())
    throw Error("network.no_points", "A network needs at least one point.", {{"points", "is empty"}});
  for (std::size_t i = 0; i < network.points.size(); ++i)
    network.points[i] = surface::checked_point(mesh, network.points[i], "points/" + std::to_string(i));
  Faults springs;
  Faults unreachable;
  for (std::size_t i = 0; i < network.springs.size(); ++i) check_spring(mesh, network, i, springs, unreachable);
  springs.throw_if_any("network.spring");
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
