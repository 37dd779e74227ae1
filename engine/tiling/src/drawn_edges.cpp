#include "drawn_edges.h"

#include <algorithm>
#include <cmath>

#include "polygon.h"

namespace supple::tiling {
namespace {

/// Distance from the chord up to which an edge is straight, in chord lengths.
constexpr double straight_tolerance = 0.003;
/// Distance up to which points of an edge are left out, in chord lengths. It doubles until few enough are left.
constexpr double first_simplification = 0.0005;

ChordLine turned(ChordLine line) {
  std::reverse(line.begin(), line.end());
  for (auto& point : line) point = Eigen::Vector2d(1, 0) - point;
  return line;
}

ChordLine mirrored(ChordLine line) {
  for (auto& point : line) point.y() = -point.y();
  return line;
}

double height(const ChordLine& line) {
  double height = 0;
  for (const auto& point : line) height = std::max(height, std::abs(point.y()));
  return height;
}

double one_sided_distance(const ChordLine& from, const ChordLine& to) {
  double greatest = 0;
  for (const auto& point : from) {
    double nearest = INFINITY;
    for (std::size_t k = 0; k + 1 < to.size(); ++k)
      nearest = std::min(nearest, distance_to_segment(point, to[k], to[k + 1]));
    greatest = std::max(greatest, nearest);
  }
  return greatest;
}

/// The first half of a line by its length, with the point at the middle.
ChordLine first_half(const ChordLine& line) {
  double length = 0;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) length += (line[k + 1] - line[k]).norm();
  ChordLine half{line.front()};
  double left = length / 2;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Eigen::Vector2d piece = line[k + 1] - line[k];
    if (piece.norm() >= left) {
      half.emplace_back(line[k] + piece * (piece.norm() > 0 ? left / piece.norm() : 0));
      break;
    }
    left -= piece.norm();
    half.push_back(line[k + 1]);
  }
  return half;
}

/// Keeps the ends and, between them, the points that lie farther than `tolerance` from the line without them
/// [Douglas and Peucker 1973]. The stack holds pieces that are still to be looked at.
ChordLine simplified(const ChordLine& line, double tolerance) {
  std::vector<char> kept(line.size(), 0);
  kept.front() = kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> pieces{{0, line.size() - 1}};
  while (!pieces.empty()) {
    const auto [begin, end] = pieces.back();
    pieces.pop_back();
    double greatest = tolerance;
    std::size_t farthest = 0;
    for (std::size_t k = begin + 1; k < end; ++k) {
      const double distance = distance_to_segment(line[k], line[begin], line[end]);
      if (distance > greatest) {
        greatest = distance;
        farthest = k;
      }
    }
    if (farthest == 0) continue;
    kept[farthest] = 1;
    pieces.emplace_back(begin, farthest);
    pieces.emplace_back(farthest, end);
  }
  ChordLine result;
  for (std::size_t k = 0; k < line.size(); ++k)
    if (kept[k]) result.push_back(line[k]);
  return result;
}

}  // namespace

ChordLine shape_line(const Polygon& outline, std::size_t begin, std::size_t end, const TileEdge& edge) {
  const Eigen::Vector2d& from = outline[begin];
  const Eigen::Vector2d chord = outline[end] - from;
  ChordLine line{Eigen::Vector2d::Zero()};
  for (std::size_t k = (begin + 1) % outline.size(); k != end; k = (k + 1) % outline.size()) {
    const Eigen::Vector2d way = outline[k] - from;
    line.emplace_back(chord.dot(way) / chord.squaredNorm(), cross(chord, way) / chord.squaredNorm());
  }
  line.emplace_back(1, 0);
  if (edge.mirrored) line = mirrored(std::move(line));
  return edge.turned ? turned(std::move(line)) : line;
}

double line_distance(const ChordLine& a, const ChordLine& b) {
  return std::max(one_sided_distance(a, b), one_sided_distance(b, a));
}

double symmetry_misfit(EdgeSymmetry symmetry, const ChordLine& line) {
  switch (symmetry) {
    case EdgeSymmetry::point_symmetric:
      return line_distance(line, turned(line));
    case EdgeSymmetry::mirror_symmetric:
      return line_distance(line, mirrored(turned(line)));
    case EdgeSymmetry::straight:
      return height(line);
    default:
      return 0;
  }
}

EdgeShape shape_of_line(EdgeSymmetry symmetry, const ChordLine& line, int max_points) {
  EdgeShape shape{symmetry, StraightEdge{}};
  if (symmetry == EdgeSymmetry::straight || height(line) <= straight_tolerance) return shape;
  const bool halved = symmetry != EdgeSymmetry::any;
  const auto whole = halved ? first_half(line) : line;
  const auto most = static_cast<std::size_t>(std::min(max_polyline_points, halved ? max_points / 2 : max_points));
  auto kept = simplified(whole, first_simplification);
  for (double tolerance = 2 * first_simplification; kept.size() > most + 1; tolerance *= 2)
    kept = simplified(whole, tolerance);
  auto& points = shape.line.emplace<PolylineEdge>().points;
  for (std::size_t k = 1; k + 1 < kept.size(); ++k) points.push_back({kept[k].x(), kept[k].y()});
  if (symmetry == EdgeSymmetry::mirror_symmetric) points.push_back({0.5, kept.back().y()});
  // An S that is drawn with nothing but its middle would be straight.
  if (points.empty()) shape.line = StraightEdge{};
  return shape;
}

}  // namespace supple::tiling
