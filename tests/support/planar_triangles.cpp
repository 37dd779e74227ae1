#include "support/planar_triangles.h"

#include <algorithm>
#include <stdexcept>

namespace supple::testing {
namespace {

using Eigen::Vector2d;

/// Sines of angles up to this count as zero, since corners within straight edges are subject to rounding.
constexpr double max_flat_sine = 1e-7;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// 1, 0 or -1 if the point p is on the left of, on, or on the right of the line from a to b.
int side(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  const Vector2d u = b - a;
  const Vector2d v = p - a;
  const double turn = cross(u, v);
  const double flat = max_flat_sine * u.norm() * v.norm();
  return turn > flat ? 1 : turn < -flat ? -1 : 0;
}

bool between(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return side(a, b, p) == 0 && (p - a).dot(b - a) > 0 && (p - b).dot(a - b) > 0;
}

/// Whether the open segments intersect, or one contains an end of the other.
bool blocks(const RingCorner& a, const RingCorner& b, const RingCorner& c, const RingCorner& d) {
  if (between(a.at, b.at, c.at) || between(a.at, b.at, d.at)) return true;
  const auto shared = [&](const RingCorner& x) { return x.vertex == c.vertex || x.vertex == d.vertex; };
  if (shared(a) || shared(b)) return false;
  if (between(c.at, d.at, a.at) || between(c.at, d.at, b.at)) return true;
  return side(a.at, b.at, c.at) * side(a.at, b.at, d.at) < 0 && side(c.at, d.at, a.at) * side(c.at, d.at, b.at) < 0;
}

bool blocked(const Ring& ring, const RingCorner& a, const RingCorner& b) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (blocks(a, b, ring[i], ring[(i + 1) % ring.size()])) return true;
  }
  return false;
}

/// Joins the hole to the polygon by the shortest segment that crosses no edge.
void bridge(Ring& outer, const std::vector<Ring>& holes, std::size_t hole) {
  const Ring& inner = holes[hole];
  double shortest = -1;
  std::size_t from = 0;
  std::size_t to = 0;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    for (std::size_t k = 0; k < inner.size(); ++k) {
      const double length = (outer[i].at - inner[k].at).norm();
      if (shortest >= 0 && length >= shortest) continue;
      bool free = !blocked(outer, outer[i], inner[k]);
      for (std::size_t other = hole; free && other < holes.size(); ++other) {
        free = !blocked(holes[other], outer[i], inner[k]);
      }
      if (!free) continue;
      shortest = length;
      from = i;
      to = k;
    }
  }
  if (shortest < 0) throw std::runtime_error("a hole cannot be joined to its outline");
  Ring way;
  for (std::size_t k = 0; k <= inner.size(); ++k) way.push_back(inner[(to + k) % inner.size()]);
  way.push_back(outer[from]);
  outer.insert(outer.begin() + static_cast<std::ptrdiff_t>(from) + 1, way.begin(), way.end());
}

/// The sine of the smallest angle of the ear at a corner; 0 if the corner is no ear.
double quality(const Ring& ring, std::size_t i) {
  const RingCorner& a = ring[(i + ring.size() - 1) % ring.size()];
  const RingCorner& b = ring[i];
  const RingCorner& c = ring[(i + 1) % ring.size()];
  if (side(a.at, b.at, c.at) <= 0) return 0;
  for (const RingCorner& p : ring) {
    if (p.vertex == a.vertex || p.vertex == b.vertex || p.vertex == c.vertex) continue;
    if (side(a.at, b.at, p.at) >= 0 && side(b.at, c.at, p.at) >= 0 && side(c.at, a.at, p.at) >= 0) return 0;
  }
  const double doubled_area = cross(b.at - a.at, c.at - a.at);
  const double ab = (b.at - a.at).norm();
  const double bc = (c.at - b.at).norm();
  const double ca = (a.at - c.at).norm();
  return doubled_area * std::min({ab, bc, ca}) / (ab * bc * ca);
}

}  // namespace

std::vector<surface::Triangle> planar_triangles(Ring outer, std::vector<Ring> holes, bool careful,
                                                RandomStream& stream) {
  for (std::size_t hole = 0; hole < holes.size(); ++hole) bridge(outer, holes, hole);
  std::vector<surface::Triangle> triangles;
  while (outer.size() >= 3) {
    double best = 0;
    std::size_t ear = 0;
    const auto first = static_cast<std::size_t>(stream.below(static_cast<int>(outer.size())));
    for (std::size_t k = 0; k < outer.size(); ++k) {
      const std::size_t i = (first + k) % outer.size();
      const double found = quality(outer, i);
      if (!(found > best)) continue;
      best = found;
      ear = i;
      if (!careful) break;
    }
    if (!(best > 0)) throw std::runtime_error("a polygon has no ear");
    const std::size_t n = outer.size();
    triangles.push_back({outer[(ear + n - 1) % n].vertex, outer[ear].vertex, outer[(ear + 1) % n].vertex});
    outer.erase(outer.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

}  // namespace supple::testing
