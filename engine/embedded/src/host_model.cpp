#include "host_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "shell_elements.h"
#include "solid_elements.h"
#include "supple/base/error.h"
#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/surface/self_crossings.h"

namespace supple::embedded {
namespace {

using Eigen::Vector3d;

/// Three nodes lie on one line if they span less area than this fraction of the squared extent of their part.
constexpr double min_area_fraction = 1e-6;

void require_positive(Faults& faults, const std::string& where, double value) {
  faults.require(std::isfinite(value) && value > 0, where, "is " + number_text(value) + ", but must be positive");
}

void check_material(Faults& faults, double youngs_modulus, double poisson_ratio) {
  require_positive(faults, "host/youngs_modulus", youngs_modulus);
  faults.require(poisson_ratio > -1 && poisson_ratio < 0.5, "host/poisson_ratio",
                 "is " + number_text(poisson_ratio) + ", but must be above -1 and below 0.5");
}

void check(const ShellHost& shell) {
  Faults faults;
  require_positive(faults, "host/thickness", shell.thickness);
  check_material(faults, shell.youngs_modulus, shell.poisson_ratio);
  faults.require(std::isfinite(shell.volume_weight) && shell.volume_weight >= 0, "host/volume_weight",
                 "is " + number_text(shell.volume_weight) + ", but must not be negative");
  require_positive(faults, "host/volume_scale", shell.volume_scale);
  faults.throw_if_any("host.invalid", "The host");
}

void check(const SolidHost& solid) {
  Faults faults;
  check_material(faults, solid.youngs_modulus, solid.poisson_ratio);
  faults.require(std::isfinite(solid.element_size) && solid.element_size >= 0, "host/element_size",
                 "is " + number_text(solid.element_size) + ", but must not be negative");
  faults.require(solid.gravity.allFinite(), "host/gravity", "is not finite");
  for (std::size_t i = 0; i < solid.regions.size(); ++i) {
    const std::string where = "host/regions/" + std::to_string(i);
    const SolidRegion& region = solid.regions[i];
    require_positive(faults, where + "/youngs_modulus", region.youngs_modulus);
    faults.require((region.lower.array() <= region.upper.array()).all(), where + "/lower",
                   "is not below the upper corner");
  }
  faults.throw_if_any("host.invalid", "The host");
}

void check_fixed(const surface::TriangleMesh& mesh, const std::vector<std::int32_t>& fixed) {
  Faults faults;
  for (std::size_t i = 0; i < fixed.size(); ++i)
    faults.require(fixed[i] >= 0 && fixed[i] < mesh.vertex_count(), "host/fixed_vertices/" + std::to_string(i),
                   "is " + std::to_string(fixed[i]) + ", but vertices are numbered from 0 to " +
                       std::to_string(mesh.vertex_count() - 1));
  faults.throw_if_any("host.fixed_vertex");
}

/// For each node the number of the connected part that it belongs to; -1 for nodes without an element. `count` becomes
/// the number of parts. Nearly O(nodes + elements).
template <class Element>
std::vector<std::int32_t> parts_of(std::size_t nodes, const std::vector<Element>& elements, std::int32_t& count) {
  std::vector<std::int32_t> parent(nodes);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t node) {
    while (parent[static_cast<std::size_t>(node)] != node) {
      std::int32_t& up = parent[static_cast<std::size_t>(node)];
      up = parent[static_cast<std::size_t>(up)];
      node = up;
    }
    return node;
  };
  std::vector<bool> used(nodes, false);
  for (const Element& element : elements) {
    for (const std::int32_t node : element) {
      used[static_cast<std::size_t>(node)] = true;
      parent[static_cast<std::size_t>(root(node))] = root(element[0]);
    }
  }
  std::vector<std::int32_t> number(nodes, -1);
  std::vector<std::int32_t> part(nodes, -1);
  count = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    if (!used[i]) continue;
    std::int32_t& own = number[static_cast<std::size_t>(root(static_cast<std::int32_t>(i)))];
    if (own < 0) own = count++;
    part[i] = own;
  }
  return part;
}

void check_moved(const surface::TriangleMesh& mesh, const std::vector<std::int32_t>& fixed,
                 const std::vector<MovedVertex>& moved) {
  Faults faults;
  std::vector<std::int32_t> sorted(fixed);
  std::sort(sorted.begin(), sorted.end());
  std::map<std::int32_t, std::size_t> known;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const std::string where = "host/moved_vertices/" + std::to_string(i);
    const std::int32_t vertex = moved[i].vertex;
    const auto known_before = known.emplace(vertex, i);
    if (vertex < 0 || vertex >= mesh.vertex_count()) {
      faults.add(where + "/vertex", "is " + std::to_string(vertex) + ", but vertices are numbered from 0 to " +
                                        std::to_string(mesh.vertex_count() - 1));
    } else if (!known_before.second) {
      faults.add(where + "/vertex", "is " + std::to_string(vertex) + ", which host/moved_vertices/" +
                                        std::to_string(known_before.first->second) + " moves already");
    } else if (std::binary_search(sorted.begin(), sorted.end(), vertex)) {
      faults.add(where + "/vertex",
                 "is " + std::to_string(vertex) + ", which is one of the fixed vertices and stays where it is");
    }
    faults.require(!moved[i].positions.empty(), where + "/positions", "is empty, but a vertex is moved somewhere");
    for (std::size_t k = 0; k < moved[i].positions.size(); ++k)
      faults.require(moved[i].positions[k].allFinite(), where + "/positions/" + std::to_string(k), "is not finite");
  }
  faults.throw_if_any("host.moved_vertex");
}

Eigen::Index largest_entry(const Vector3d& v) {
  Eigen::Index at = 0;
  v.cwiseAbs().maxCoeff(&at);
  return at;
}

}  // namespace

HostModel::HostModel(const surface::TriangleMesh& mesh, const Host& host, const Execution& execution) {
  if (const auto* shell = std::get_if<ShellHost>(&host)) make_shell(mesh, *shell);
  if (const auto* solid = std::get_if<SolidHost>(&host)) make_solid(mesh, *solid, execution);
}

void HostModel::make_shell(const surface::TriangleMesh& mesh, const ShellHost& shell) {
  check(shell);
  check_fixed(mesh, shell.fixed_vertices);
  check_moved(mesh, shell.fixed_vertices, shell.moved_vertices);
  terms_.push_back(std::make_shared<ShellMembrane>(mesh, shell));
  if (shell.bending) terms_.push_back(std::make_shared<ShellHinges>(mesh, shell));
  if (shell.volume_weight > 0) terms_.push_back(std::make_shared<ShellVolume>(mesh, shell));
  place_nodes(mesh.positions());
  fix_vertices(shell.fixed_vertices, shell.moved_vertices);
  constrain_parts(mesh.faces(), false);
  stiffness_ = shell.youngs_modulus * shell.thickness;
}

void HostModel::make_solid(const surface::TriangleMesh& mesh, const SolidHost& solid, const Execution& execution) {
  check(solid);
  check_fixed(mesh, solid.fixed_vertices);
  check_moved(mesh, solid.fixed_vertices, solid.moved_vertices);
  {
    const StageTimer timer(execution.cost, "tetrahedra");
    surface::require_no_self_crossings(mesh, execution);
    tetrahedra_ = meshing::fill(mesh.positions(), mesh.faces(), {.element_size = solid.element_size}, execution);
  }
  terms_.push_back(std::make_shared<SolidElements>(tetrahedra_, solid));
  if (!solid.gravity.isZero(0)) terms_.push_back(std::make_shared<Gravity>(tetrahedra_, solid.gravity));
  place_nodes(tetrahedra_.nodes);
  fix_vertices(solid.fixed_vertices, solid.moved_vertices);
  constrain_parts(tetrahedra_.tetrahedra, !solid.gravity.isZero(0));
  stiffness_ = solid.youngs_modulus;
  for (const SolidRegion& region : solid.regions) stiffness_ = std::max(stiffness_, region.youngs_modulus);
  stiffness_ *= mesh.mean_edge_length();
}

void HostModel::place_nodes(std::span<const Vector3d> positions) {
  nodes_.resize(3 * static_cast<Eigen::Index>(positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i) nodes_.segment<3>(3 * static_cast<Eigen::Index>(i)) = positions[i];
  fixed_.assign(static_cast<std::size_t>(nodes_.size()), false);
}

void HostModel::fix(std::int32_t node) {
  for (std::size_t k = 0; k < 3; ++k) fixed_[3 * static_cast<std::size_t>(node) + k] = true;
}

void HostModel::fix_vertices(const std::vector<std::int32_t>& fixed, const std::vector<MovedVertex>& moved) {
  for (const std::int32_t vertex : fixed) fix(vertex);
  for (const MovedVertex& one : moved) fix(one.vertex);
  moved_ = moved;
}

template <class Element>
void HostModel::constrain_parts(const std::vector<Element>& elements, bool is_loaded) {
  const auto count = static_cast<std::size_t>(nodes_.size() / 3);
  std::int32_t parts = 0;
  const std::vector<std::int32_t> part = parts_of(count, elements, parts);
  std::vector<std::vector<std::size_t>> nodes_of(static_cast<std::size_t>(parts));
  for (std::size_t i = 0; i < count; ++i) {
    if (part[i] < 0)
      fix(static_cast<std::int32_t>(i));
    else
      nodes_of[static_cast<std::size_t>(part[i])].push_back(i);
  }
  std::vector<bool> is_moved(nodes_of.size(), false);
  for (const MovedVertex& one : moved_)
    if (const std::int32_t p = part[static_cast<std::size_t>(one.vertex)]; p >= 0)
      is_moved[static_cast<std::size_t>(p)] = true;
  for (std::size_t p = 0; p < nodes_of.size(); ++p) constrain_part(nodes_of[p], is_loaded, is_moved[p]);
}

// A body stays in its place if three nodes that are not on a line have three, two and one fixed coordinates. These
// constraints take no force where forces and moments sum to zero, as those of networks and hosts do.
void HostModel::constrain_part(const std::vector<std::size_t>& nodes, bool is_loaded, bool is_moved) {
  // Fixed nodes are preferred to free ones.
  const auto best = [&](const auto& score) {
    std::size_t chosen = nodes.front();
    double highest = -1;
    for (const bool among_fixed : {true, false}) {
      for (const std::size_t i : nodes) {
        if (is_fixed(i) != among_fixed || !(score(i) > highest)) continue;
        highest = score(i);
        chosen = i;
      }
      if (highest > 0) break;
    }
    return chosen;
  };
  Vector3d low = position(nodes.front());
  Vector3d high = low;
  for (const std::size_t i : nodes) {
    low = low.cwiseMin(position(i));
    high = high.cwiseMax(position(i));
  }
  const double min_area = min_area_fraction * (high - low).squaredNorm();
  const std::size_t first = best([&](std::size_t) { return 1.0; });
  const std::size_t second = best([&](std::size_t i) {
    const Vector3d apart = position(i) - position(first);
    return apart.squaredNorm() > min_area ? apart.norm() : 0;
  });
  const Vector3d axis = position(second) - position(first);
  const std::size_t third = best([&](std::size_t i) {
    const double area = axis.cross(position(i) - position(first)).norm();
    return area > min_area ? area : 0;
  });
  if (is_fixed(first) && is_fixed(second) && is_fixed(third)) return;
  if (is_loaded)
    throw Error("host.unsupported",
                "A solid under gravity has to be held by at least three fixed vertices that are not on one line.",
                {{"host/fixed_vertices", "leave a part of the solid free to move as a whole"}});
  // The constrained nodes would have to follow the moved vertices, along a path that is not known beforehand.
  if (is_moved)
    throw Error("host.unsupported",
                "A host of which vertices are moved has to be held by at least three vertices that are not on one "
                "line, fixed or moved.",
                {{"host/moved_vertices", "and fixed_vertices leave a part of the host free to move as a whole"}});
  ++rigid_body_constraints_;
  if (!is_fixed(first)) fix(static_cast<std::int32_t>(first));
  if (!is_fixed(second)) {
    const auto along = static_cast<std::size_t>(largest_entry(axis));
    for (std::size_t k = 0; k < 3; ++k)
      if (k != along) fixed_[3 * second + k] = true;
  }
  const auto normal = static_cast<std::size_t>(largest_entry(axis.cross(position(third) - position(first))));
  fixed_[3 * third + normal] = true;
}

}  // namespace supple::embedded
