#include "torus_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <tuple>

#include "supple/base/error.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

/// Points of the torus that are closer are one point (mm): some 1e7 roundings, a thousandth of the shortest side of a
/// hole.
constexpr double matching_tolerance = 1e-6;

/// Largest relative difference between the length of the outline and that of the holes' sides.
constexpr double length_tolerance = 1e-6;

constexpr std::size_t max_details = 8;

struct TorusPoint {
  int node = 0;
  Eigen::Vector2i shift = Eigen::Vector2i::Zero();
};

LatticeShift to_shift(const Eigen::Vector2i& shift) {
  if (shift.cwiseAbs().maxCoeff() > 127) {
    throw TilingError("tiling.mesh_not_periodic", "A tile reaches over more than 127 translations of its cell.");
  }
  return {static_cast<std::int8_t>(shift[0]), static_cast<std::int8_t>(shift[1])};
}

/// Gives every point of the torus one node.
class NodeMatcher {
 public:
  explicit NodeMatcher(const Eigen::Matrix2d& lattice) : lattice_(lattice), inverse_(lattice.inverse()) {
    coordinate_tolerance_ = matching_tolerance * inverse_.row(0).norm();
  }

  TorusPoint add(const Eigen::Vector2d& p, bool seam) {
    if (!seam) return append(p);
    const double u = inverse_.row(0).dot(p) - std::floor(inverse_.row(0).dot(p));
    // u is periodic: near 0 and near 1 are neighbours.
    for (const double candidate : {u, u - 1, u + 1}) {
      const auto end = by_first_coordinate_.upper_bound(candidate + coordinate_tolerance_);
      for (auto at = by_first_coordinate_.lower_bound(candidate - coordinate_tolerance_); at != end; ++at) {
        const Eigen::Vector2d difference = p - nodes[at->second];
        const Eigen::Vector2d shift = (inverse_ * difference).array().round();
        if ((difference - lattice_ * shift).norm() < matching_tolerance) return {at->second, shift.cast<int>()};
      }
    }
    TorusPoint point = append(p);
    by_first_coordinate_.emplace(u, point.node);
    return point;
  }

  std::vector<Eigen::Vector2d> nodes;

 private:
  TorusPoint append(const Eigen::Vector2d& p) {
    nodes.push_back(p);
    return {static_cast<int>(nodes.size()) - 1, Eigen::Vector2i::Zero()};
  }

  Eigen::Matrix2d lattice_, inverse_;
  double coordinate_tolerance_;
  std::multimap<double, int> by_first_coordinate_;
};

/// A side of the torus: its nodes a and b, and the lattice shift from a to b. Each side has two such tuples, one for
/// each direction. The smaller one is its key.
using SideKey = std::tuple<int, int, int, int>;

struct SideUse {
  int triangle = 0;
  int side = 0;
  int uses = 1;
  bool forward = true;
  int midpoint = 0;
  Eigen::Vector2i shift;  // shift of the midpoint relative to that of the key's first corner
};

std::string position_text(const Eigen::Vector2d& p) {
  std::ostringstream text;
  text << "(" << p.x() << ", " << p.y() << ") mm";
  return text.str();
}

}  // namespace

PeriodicMesh wrap(const TriangleSoup& soup, const Eigen::Matrix2d& lattice, double outline_length) {
  PeriodicMesh mesh;
  mesh.lattice = lattice;
  NodeMatcher matcher(lattice);
  std::vector<TorusPoint> points;
  points.reserve(soup.points.size());
  for (std::size_t k = 0; k < soup.points.size(); ++k) points.push_back(matcher.add(soup.points[k], soup.seam[k] != 0));

  std::map<SideKey, SideUse> sides;
  std::vector<Error::Detail> details;
  const auto report = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const char* what) {
    if (details.size() < max_details)
      details.push_back({"side from " + position_text(a) + " to " + position_text(b), what});
  };
  for (const auto& corners : soup.triangles) {
    const int t = static_cast<int>(mesh.triangles.size());
    auto& nodes = mesh.triangles.emplace_back();
    auto& shifts = mesh.shifts.emplace_back();
    for (int k = 0; k < 3; ++k) {
      nodes[k] = points[corners[k]].node;
      shifts[k] = to_shift(points[corners[k]].shift);
    }
    for (int k = 0; k < 3; ++k) {
      const TorusPoint &a = points[corners[k]], &b = points[corners[(k + 1) % 3]];
      const Eigen::Vector2i difference = b.shift - a.shift;
      const SideKey along(a.node, b.node, difference[0], difference[1]),
          against(b.node, a.node, -difference[0], -difference[1]);
      const bool forward = along < against;
      const Eigen::Vector2i& base = forward ? a.shift : b.shift;
      const auto [found, is_new] = sides.try_emplace(forward ? along : against);
      SideUse& use = found->second;
      if (is_new) {
        const Eigen::Vector2d middle =
            (matcher.nodes[a.node] + matcher.nodes[b.node] + lattice * difference.cast<double>()) / 2;
        // The node is placed so that the midpoint has the shift of corner a in this triangle.
        use = {.triangle = t,
               .side = k,
               .forward = forward,
               .midpoint = matcher.add(middle, false).node,
               .shift = a.shift - base};
      } else if (++use.uses > 2 || use.forward == forward) {
        report(soup.points[corners[k]], soup.points[corners[(k + 1) % 3]], "has more than one triangle on a side");
      }
      nodes[3 + k] = use.midpoint;
      shifts[3 + k] = to_shift(base + use.shift);
    }
  }

  double length = 0;
  for (const auto& [key, use] : sides) {
    if (use.uses != 1) continue;
    mesh.outline.push_back({use.triangle, use.side});
    const auto& corners = soup.triangles[use.triangle];
    const int a = corners[use.side], b = corners[(use.side + 1) % 3];
    length += (soup.points[b] - soup.points[a]).norm();
  }
  std::sort(mesh.outline.begin(), mesh.outline.end(), [](const PeriodicMesh::Side& a, const PeriodicMesh::Side& b) {
    return std::tie(a.triangle, a.side) < std::tie(b.triangle, b.side);
  });
  if (std::abs(length - outline_length) > length_tolerance * (length + outline_length)) {
    for (const auto& [triangle, side] : mesh.outline) {
      const auto& corners = soup.triangles[triangle];
      const int a = corners[side], b = corners[(side + 1) % 3];
      if (soup.seam[a] && soup.seam[b]) report(soup.points[a], soup.points[b], "has no partner");
    }
    if (details.empty()) details.push_back({"outline", "has not the length of the holes' sides"});
  }
  if (!details.empty()) {
    throw TilingError(
        "tiling.mesh_not_periodic",
        "The mesh does not close over the sides of tiles: the " + details[0].where + " " + details[0].message + ".",
        details);
  }

  mesh.nodes.resize(2, static_cast<Eigen::Index>(matcher.nodes.size()));
  for (std::size_t k = 0; k < matcher.nodes.size(); ++k)
    mesh.nodes.col(static_cast<Eigen::Index>(k)) = matcher.nodes[k];
  return mesh;
}

}  // namespace supple::tiling
