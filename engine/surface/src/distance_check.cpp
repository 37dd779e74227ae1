#include "distance_check.h"

#include <cmath>
#include <sstream>
#include <string>

#include "supple/base/error.h"

namespace supple::surface {
namespace {

/// Distances that contradict each other by less than this relative amount differ by rounding.
constexpr double consistency_tolerance = 1e-9;

std::string with_all_digits(double x) {
  std::ostringstream text;
  text.precision(15);
  text << x;
  return text.str();
}

std::string distance_of(std::int32_t v, double distance) {
  const std::string vertex = "vertex " + std::to_string(v);
  return distance < infinity ? "the distance of " + vertex + " is " + with_all_digits(distance)
                             : vertex + " is not reached";
}

[[noreturn]] void throw_inconsistent(std::int32_t v, double found, std::int32_t neighbour, double known, double edge) {
  std::string subject = distance_of(v, found);
  subject[0] = subject[0] == 't' ? 'T' : 'V';
  throw Error("geodesic.inconsistent",
              subject + ", but " + distance_of(neighbour, known) + ", and the edge between the two is " +
                  with_all_digits(edge) + " long. The distances are therefore not given.",
              {{"vertex " + std::to_string(v), "is at most " + with_all_digits(known + edge) + " from the source"},
               {"vertex " + std::to_string(neighbour), "is its neighbour"}});
}

}  // namespace

void check_distances(const TriangleMesh& mesh, std::span<const double> distances, double relative_error, double limit) {
  const double factor = (1 + relative_error) * (1 + consistency_tolerance);
  const double* const d = distances.data();
  std::int32_t h = 0;
  for (const Triangle& face : mesh.faces()) {
    for (int i = 0; i < 3; ++i, ++h) {
      const double a = d[face[i]];
      const double b = d[face[i == 2 ? 0 : i + 1]];
      const double near = std::min(a, b);
      const double far = std::max(a, b);
      const double max_distance = (near + mesh.edge_length(h)) * factor;
      if (far <= max_distance) continue;
      if (far == infinity && max_distance > limit) continue;
      const std::int32_t tail = face[i];
      const std::int32_t head = face[i == 2 ? 0 : i + 1];
      throw_inconsistent(a > b ? tail : head, far, a > b ? head : tail, near, mesh.edge_length(h));
    }
  }
}

void check_target(const WindowSearch& search, const SearchTarget& target) {
  const TriangleMesh& mesh = *search.mesh().mesh;
  const double length = target.best.length;
  const auto check = [&](std::int32_t v, std::int32_t neighbour, double edge, double remaining_length) {
    const double known = search.distance(neighbour);
    if (length <= (known + edge + remaining_length) * (1 + consistency_tolerance)) return;
    throw_inconsistent(v, length - remaining_length, neighbour, known, edge);
  };
  if (target.best.kind == Arrival::Kind::none) {
    throw Error("geodesic.inconsistent", "No path has been found to a point of the same connected component.");
  }
  if (target.vertex < 0) {
    const std::int32_t face = index(target.point.face);
    for (int side = 0; side < 3; ++side) {
      const std::int32_t across = mesh.twin(3 * face + side);
      if (across < 0) continue;
      // The path passes the opposite corner of the face beyond the side, and then an end of the side.
      const std::int32_t tail = mesh.faces()[face][side];
      check(tail, mesh.tail(TriangleMesh::previous(across)), mesh.edge_length(TriangleMesh::next(across)),
            target.planar[side].norm());
    }
    return;
  }
  const std::int32_t first = mesh.outgoing(target.vertex);
  std::int32_t h = first;
  do {
    check(target.vertex, mesh.head(h), mesh.edge_length(h), 0);
    const std::int32_t back = TriangleMesh::previous(h);
    check(target.vertex, mesh.tail(back), mesh.edge_length(back), 0);
    h = mesh.rotate(h);
  } while (h >= 0 && h != first);
}

}  // namespace supple::surface
