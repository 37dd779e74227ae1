#include "support/cad_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "supple/base/error.h"
#include "support/parametric.h"
#include "support/planar_triangles.h"

namespace supple::testing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;
using Loop = std::vector<Vector2d>;

bool happens(RandomStream& stream, double probability) { return stream.uniform() < probability; }

// Counterclockwise outlines, about 10 to 40 wide.

Loop sharp_outline(RandomStream& stream) {
  const double a = stream.uniform(10, 40);
  const double b = stream.uniform(8, 30);
  const double c = a * stream.uniform(0.3, 0.6);
  const double d = b * stream.uniform(0.3, 0.6);
  switch (stream.below(6)) {
    case 0:
      return {{0, 0}, {a, 0}, {a, b}, {0, b}};
    case 1:
      return {{0, 0}, {a, 0}, {a, d}, {c, d}, {c, b}, {0, b}};
    case 2:
      return {{0, 0}, {a, 0}, {a, b}, {a - 0.3 * c, b}, {a - 0.3 * c, d}, {0.4 * c, d}, {0.4 * c, b}, {0, b}};
    case 3:
      return {{0, 0}, {a, 0}, {a, d}, {a - 0.3 * c, d}, {a - 0.3 * c, b}, {0.4 * c, b}, {0.4 * c, d}, {0, d}};
    case 4:
      return {{0, 0}, {a, 0}, {a + 0.3 * c, d}, {a - 0.2 * c, b}, {0.1 * c, b}};
    default:
      break;
  }
  Loop polygon;
  const int n = 3 + stream.below(9);
  for (int i = 0; i < n; ++i)
    polygon.emplace_back(0.5 * a * std::cos(2 * pi * i / n), 0.5 * a * std::sin(2 * pi * i / n));
  return polygon;
}

/// An outline with some corners rounded or chamfered.
Loop outline(RandomStream& stream) {
  const Loop sharp = sharp_outline(stream);
  const double rounded = stream.uniform();
  Loop result;
  for (std::size_t i = 0; i < sharp.size(); ++i) {
    const Vector2d& corner = sharp[i];
    const Vector2d back = sharp[(i + sharp.size() - 1) % sharp.size()] - corner;
    const Vector2d ahead = sharp[(i + 1) % sharp.size()] - corner;
    const double cut = stream.uniform(0.05, 0.45) * std::min(back.norm(), ahead.norm());
    if (!happens(stream, rounded)) {
      result.push_back(corner);
      continue;
    }
    const Vector2d begin = corner + cut * back.normalized();
    const Vector2d end = corner + cut * ahead.normalized();
    const double half = 0.5 * std::acos(std::clamp(back.normalized().dot(ahead.normalized()), -1.0, 1.0));
    const Vector2d centre =
        corner + cut / (std::cos(half) * std::cos(half)) * (0.5 * (back.normalized() + ahead.normalized()));
    const int pieces = 1 + stream.below(6);
    const Vector2d from = begin - centre;
    const double turn =
        std::atan2(from.x() * (end - centre).y() - from.y() * (end - centre).x(), from.dot(end - centre));
    result.push_back(begin);
    for (int k = 1; k < pieces; ++k) {
      result.push_back(centre + Eigen::Rotation2Dd(turn * k / pieces) * from);
    }
    result.push_back(end);
  }
  return result;
}

double distance_to_segment(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - along * (b - a)).norm();
}

/// Distance of a point from the outline; negative if the point is outside.
double depth_within(const Loop& outline, const Vector2d& p) {
  double least = 1e9;
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d& a = outline[i];
    const Vector2d& b = outline[(i + 1) % outline.size()];
    least = std::min(least, distance_to_segment(p, a, b));
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside ? least : -least;
}

/// The clockwise outline of a hole within a circle: round, hexagonal, or a slot.
Loop opening(RandomStream& stream, const Vector2d& centre, double radius) {
  Loop loop;
  const double first = stream.uniform(0, pi);
  if (happens(stream, 0.3)) {
    // A rectangle whose corners lie on the circle, at angles that do not depend on the radius.
    const double half = stream.uniform(0.2, 1.2);
    for (const double angle : {half, pi - half, pi + half, -half})
      loop.push_back(centre + radius * Vector2d(std::cos(first + angle), std::sin(first + angle)));
  } else {
    const int n = std::array{6, 8, 12, 16, 24}[static_cast<std::size_t>(stream.below(5))];
    for (int i = 0; i < n; ++i) {
      const double angle = first + 2 * pi * i / n;
      loop.push_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  std::reverse(loop.begin(), loop.end());
  return loop;
}

/// Assembles the part.
class Builder {
 public:
  explicit Builder(RandomStream& stream)
      : stream_(stream), careful_(happens(stream, 0.5)), dense_(stream.uniform(0, 1.5)) {}

  Soup soup;
  std::string what;

  void build() {
    const Loop profile = outline(stream_);
    const double height = stream_.uniform(2, 20);
    // The kinds are: closed; without the bottom; only walls; a flat sheet; a sheet with some of its walls.
    const int kind = std::array{0, 0, 0, 0, 1, 1, 2, 3, 4, 4}[static_cast<std::size_t>(stream_.below(10))];
    what = std::array{"closed", "without bottom", "walls", "sheet", "sheet with flaps"}[static_cast<std::size_t>(kind)];
    what += ", " + std::to_string(profile.size()) + " corners";
    const Ring top = ring(profile, height);
    if (kind != 3) {
      const Ring bottom = ring(profile, 0);
      walls(profile, bottom, top, kind == 4 ? 0.5 : 1);
      bottom_ = bottom;
    }
    if (kind == 2) return;
    std::vector<Ring> holes;
    std::vector<Ring> through;
    std::vector<std::pair<Vector2d, double>> circles;
    const int wanted = stream_.below(4);
    for (int tries = 0; tries < 30 && static_cast<int>(circles.size()) < wanted; ++tries) {
      const Vector2d centre(stream_.uniform(-20, 40), stream_.uniform(-20, 30));
      const double radius = stream_.uniform(0.6, 5);
      bool fits = depth_within(profile, centre) > 1.15 * radius;
      for (const auto& [other, size] : circles) fits = fits && (centre - other).norm() > 1.1 * (radius + size);
      if (!fits) continue;
      circles.emplace_back(centre, radius);
      add_feature(opening(stream_, centre, radius), height, kind, holes, through);
    }
    fill(top, holes, false);
    if (kind == 0) fill(reversed(bottom_), through, true);
  }

 private:
  static Ring reversed(Ring ring) {
    std::reverse(ring.begin(), ring.end());
    return ring;
  }

  void add_feature(const Loop& loop, double height, int kind, std::vector<Ring>& holes, std::vector<Ring>& through) {
    const Ring rim = ring(loop, height);
    holes.push_back(rim);
    if (kind == 3) {
      what += ", hole";
      return;
    }
    switch (stream_.below(3)) {
      case 0: {
        what += ", through hole";
        const Ring low = ring(loop, 0);
        walls(loop, low, rim, 1);
        // The bottom is triangulated as seen from below, where the orientation of the hole is reversed.
        through.push_back(reversed(low));
        return;
      }
      case 1: {
        what += ", pocket";
        const Ring floor = ring(loop, height * stream_.uniform(0.2, 0.8));
        walls(loop, floor, rim, 1);
        fill(reversed(floor), {}, false);
        return;
      }
      default: {
        what += ", boss";
        Loop around = loop;
        std::reverse(around.begin(), around.end());
        const Ring top = ring(around, height * stream_.uniform(1.2, 2));
        walls(around, start_at(reversed(rim), around), top, 1);
        fill(top, {}, false);
      }
    }
  }

  /// The same ring, beginning with the first corner of the loop.
  static Ring start_at(Ring ring, const Loop& loop) {
    const auto first = std::find_if(ring.begin(), ring.end(), [&](const RingCorner& c) { return c.at == loop[0]; });
    std::rotate(ring.begin(), first, ring.end());
    return ring;
  }

  /// Random places within an edge, relative to its length, ascending.
  std::vector<double> places(double length) {
    std::vector<double> result;
    if (length < 1.5) return result;
    while (happens(stream_, 0.3 * dense_) && result.size() < 4) {
      result.push_back(happens(stream_, 0.1) ? stream_.uniform(1e-4, 1e-2) : stream_.uniform(0.05, 0.95));
    }
    std::sort(result.begin(), result.end());
    return result;
  }

  /// The loop at a height, with additional vertices within its edges.
  Ring ring(const Loop& loop, double z) {
    Ring result;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vector2d& a = loop[i];
      const Vector2d& b = loop[(i + 1) % loop.size()];
      const auto add = [&](const Vector2d& p) { result.push_back({p, soup.add({p.x(), p.y(), z})}); };
      add(a);
      for (const double t : places((b - a).norm())) add(a + t * (b - a));
    }
    return result;
  }

  /// Walls between two rings of the loop, which differ in their vertices within the edges. Material is on the left of
  /// the loop.
  void walls(const Loop& loop, const Ring& low, const Ring& high, double share) {
    const std::size_t n = loop.size();
    std::vector<std::optional<std::vector<std::int32_t>>> uprights(n);
    const auto upright = [&](std::size_t i, std::int32_t below,
                             std::int32_t above) -> const std::vector<std::int32_t>& {
      if (!uprights[i]) {
        const Vector3d a = soup.positions[static_cast<std::size_t>(below)];
        const Vector3d b = soup.positions[static_cast<std::size_t>(above)];
        uprights[i].emplace();
        if (n < 12) {
          for (const double t : places((b - a).norm())) uprights[i]->push_back(soup.add(a + t * (b - a)));
        }
      }
      return *uprights[i];
    };
    const auto piece = [&](const Ring& ring, std::size_t& at, std::size_t i) {
      // The vertices from corner i to the next corner, both included.
      Ring result{ring[at]};
      do {
        at = (at + 1) % ring.size();
        result.push_back(ring[at]);
      } while (ring[at].at != loop[(i + 1) % n]);
      return result;
    };
    std::size_t low_at = 0;
    std::size_t high_at = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Ring below = piece(low, low_at, i);
      const Ring above = piece(high, high_at, i);
      if (!happens(stream_, share)) continue;
      const Vector2d along = (loop[(i + 1) % n] - loop[i]).normalized();
      Ring wall;
      const auto add = [&](std::int32_t v) {
        const Vector3d& p = soup.positions[static_cast<std::size_t>(v)];
        wall.push_back({{(Vector2d(p.x(), p.y()) - loop[i]).dot(along), p.z()}, v});
      };
      for (const RingCorner& c : below) add(c.vertex);
      for (const std::int32_t v : upright((i + 1) % n, below.back().vertex, above.back().vertex)) add(v);
      for (const RingCorner& c : reversed(above)) add(c.vertex);
      const std::vector<std::int32_t>& left = upright(i, below.front().vertex, above.front().vertex);
      for (auto v = left.rbegin(); v != left.rend(); ++v) add(*v);
      append(planar_triangles(wall, {}, careful_, stream_));
    }
  }

  void fill(const Ring& outer, const std::vector<Ring>& holes, bool mirrored) {
    Ring own = outer;
    std::vector<Ring> inner = holes;
    if (mirrored) {
      const auto mirror = [](Ring& ring) {
        for (RingCorner& c : ring) c.at.x() = -c.at.x();
      };
      mirror(own);
      for (Ring& hole : inner) mirror(hole);
    }
    append(planar_triangles(own, inner, careful_, stream_));
  }

  void append(const std::vector<surface::Triangle>& faces) {
    soup.faces.insert(soup.faces.end(), faces.begin(), faces.end());
  }

  RandomStream& stream_;
  bool careful_;
  double dense_;  ///< density of the vertices within straight edges
  Ring bottom_;
};

/// Splits random edges at a new vertex in all of their faces, as the repair of a T-vertex does.
void split_edges(Soup& soup, int count, RandomStream& stream) {
  for (int k = 0; k < count; ++k) {
    const surface::Triangle& face =
        soup.faces[static_cast<std::size_t>(stream.below(static_cast<int>(soup.faces.size())))];
    const auto i = static_cast<std::size_t>(stream.below(3));
    const std::int32_t a = face[i];
    const std::int32_t b = face[(i + 1) % 3];
    const double t = happens(stream, 0.1) ? stream.uniform(1e-5, 1e-2) : stream.uniform(0.05, 0.95);
    const Vector3d from = soup.positions[static_cast<std::size_t>(a)];
    const Vector3d to = soup.positions[static_cast<std::size_t>(b)];
    if ((to - from).norm() < 0.1) continue;
    const std::int32_t middle = soup.add(from + t * (to - from));
    const std::size_t faces = soup.faces.size();
    for (std::size_t f = 0; f < faces; ++f) {
      for (std::size_t side = 0; side < 3; ++side) {
        const surface::Triangle old = soup.faces[f];
        const std::int32_t p = old[side];
        const std::int32_t q = old[(side + 1) % 3];
        if (!((p == a && q == b) || (p == b && q == a))) continue;
        const std::int32_t r = old[(side + 2) % 3];
        soup.faces[f] = {p, middle, r};
        soup.faces.push_back({middle, q, r});
        break;
      }
    }
  }
}

void drop_unused(Soup& soup) {
  std::map<std::int32_t, std::int32_t> numbers;
  std::vector<Vector3d> used;
  for (surface::Triangle& face : soup.faces) {
    for (std::int32_t& v : face) {
      const auto [place, added] = numbers.try_emplace(v, static_cast<std::int32_t>(used.size()));
      if (added) used.push_back(soup.positions[static_cast<std::size_t>(v)]);
      v = place->second;
    }
  }
  soup.positions = std::move(used);
}

double as_written(double x, Digits digits) {
  if (digits == Digits::single_precision) return static_cast<double>(static_cast<float>(x));
  if (digits == Digits::all) return x;
  std::array<char, 40> text{};
  (void)std::snprintf(text.data(), text.size(), "%.6g", x);
  return std::strtod(text.data(), nullptr);
}

CadPart drawn(RandomStream& stream) {
  Builder builder(stream);
  builder.build();
  Soup& soup = builder.soup;
  const int splits = stream.below(4) * stream.below(5);
  split_edges(soup, splits, stream);
  drop_unused(soup);
  CadPart part;
  part.description = builder.what + ", " + std::to_string(splits) + " edges split";
  if (happens(stream, 0.4)) {
    const double size = 30 * std::pow(10, stream.uniform(-12, -6));
    for (Vector3d& p : soup.positions) {
      if (happens(stream, 0.3)) p += size * Vector3d(stream.normal(), stream.normal(), stream.normal());
    }
    part.description += ", moved by " + std::to_string(std::log10(size));
  }
  if (happens(stream, 0.7)) {
    Eigen::Quaterniond turn(stream.normal(), stream.normal(), stream.normal(), stream.normal());
    turn.normalize();
    const Vector3d shift = 50 * stream.uniform() * Vector3d(stream.normal(), stream.normal(), stream.normal());
    for (Vector3d& p : soup.positions) p = turn * p + shift;
    part.description += ", turned";
  }
  part.digits = std::array{Digits::all, Digits::single_precision, Digits::single_precision,
                           Digits::six}[static_cast<std::size_t>(stream.below(4))];
  part.description += std::array{"", ", single precision", ", six digits"}[static_cast<std::size_t>(part.digits)];
  for (Vector3d& p : soup.positions) {
    for (int i = 0; i < 3; ++i) p[i] = as_written(p[i], part.digits);
  }
  part.mesh = std::move(soup).build();
  return part;
}

}  // namespace

CadPart cad_part(RandomStream& stream) {
  while (true) {
    try {
      CadPart part = drawn(stream);
      if (part.mesh.component_count() == 1 && part.mesh.vertex_count() <= 400) return part;
    } catch (const Error&) {
      // Rounding has made a face degenerate, or walls touch in a vertex.
    } catch (const std::runtime_error&) {
      // Rounding has left a polygon without an ear.
    }
  }
}

}  // namespace supple::testing
