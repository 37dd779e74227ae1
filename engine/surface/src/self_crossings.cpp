#include "supple/surface/self_crossings.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "face_tree.h"
#include "supple/base/error.h"

namespace supple::surface {
namespace {

/// Six times the volume of the tetrahedron a b c d, or 0 if rounding may have changed its sign. The error bound is that
/// of stage A in [Shewchuk1997].
double certified_volume(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                        const Eigen::Vector3d& d) {
  const Eigen::Vector3d u = a - d, v = b - d, w = c - d;
  const double volume = u.dot(v.cross(w));
  const auto terms = [](double x, double y, double z, double t) { return std::abs(x * y) + std::abs(z * t); };
  const double permanent = terms(v[1], w[2], v[2], w[1]) * std::abs(u[0]) +
                           terms(v[2], w[0], v[0], w[2]) * std::abs(u[1]) +
                           terms(v[0], w[1], v[1], w[0]) * std::abs(u[2]);
  constexpr double bound = 8 * std::numeric_limits<double>::epsilon();
  return std::abs(volume) > bound * permanent ? volume : 0;
}

/// The fraction from p to q at which the segment intersects the inside of the triangle; negative if this is not
/// certain.
double crossing_fraction(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                         const std::array<Eigen::Vector3d, 3>& triangle) {
  const double above = certified_volume(triangle[0], triangle[1], triangle[2], p);
  const double below = certified_volume(triangle[0], triangle[1], triangle[2], q);
  if (!(above * below < 0)) return -1;
  int turns = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double volume = certified_volume(p, q, triangle.at(i), triangle.at((i + 1) % 3));
    if (volume == 0) return -1;
    turns += volume > 0 ? 1 : -1;
  }
  if (std::abs(turns) != 3) return -1;
  return above / (above - below);
}

std::string place_text(const Eigen::Vector3d& place) {
  std::ostringstream text;
  text.precision(6);
  text << '(' << place[0] << ", " << place[1] << ", " << place[2] << ')';
  return text.str();
}

}  // namespace

std::vector<SelfCrossing> find_self_crossings(const TriangleMesh& mesh, std::size_t max_count,
                                              const Execution& execution) {
  const auto& positions = mesh.positions();
  const FaceTree tree(positions, mesh.faces(), execution);
  StopPace pace(execution.cancellation);
  std::vector<SelfCrossing> crossings;
  for (std::int32_t h = 0; h < mesh.halfedge_count() && crossings.size() < max_count; ++h) {
    if (mesh.twin(h) > h) continue;  // each edge once
    const std::int32_t tail = mesh.tail(h), head = mesh.head(h);
    const Eigen::Vector3d &p = positions[tail], &q = positions[head];
    FaceTree::Box box(p);
    box.extend(q);
    tree.visit_overlaps(box, [&](std::int32_t f) {
      pace.check();
      const Triangle& face = mesh.faces()[f];
      for (const std::int32_t v : face)
        if (v == tail || v == head) return;
      const double fraction = crossing_fraction(p, q, {positions[face[0]], positions[face[1]], positions[face[2]]});
      if (fraction < 0 || crossings.size() >= max_count) return;
      crossings.push_back({TriangleMesh::face_of(h), f, p + fraction * (q - p)});
    });
  }
  return crossings;
}

void require_no_self_crossings(const TriangleMesh& mesh, const Execution& execution) {
  constexpr std::size_t max_named = 20;
  const auto crossings = find_self_crossings(mesh, max_named, execution);
  if (crossings.empty()) return;
  std::vector<Error::Detail> details;
  details.reserve(crossings.size());
  for (const SelfCrossing& crossing : crossings) {
    details.push_back({"face " + std::to_string(crossing.face),
                       "crosses face " + std::to_string(crossing.crossed) + " at " + place_text(crossing.place)});
  }
  throw Error("solid.self_crossing",
              "The surface crosses itself and therefore encloses no solid: face " +
                  std::to_string(crossings.front().face) + " crosses face " +
                  std::to_string(crossings.front().crossed) + " at " + place_text(crossings.front().place) + ".",
              std::move(details));
}

}  // namespace supple::surface
