#include "canonical_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <unordered_map>

#include "supple/base/seeded_hash.h"

namespace supple::meshing {
namespace {

/// Positions are rounded to this grid. Rounding errors of a rotation, about 1e-16, rarely change the rounded position.
constexpr double grid = 1.0 / (1 << 30);
/// Resolution at which lengths distinguish vertices, far above rounding errors.
constexpr double resolution = 1.0 / (1 << 22);
/// Smallest distance of the first vertex of the frame from the centre, and of the second one from the line through
/// both.
constexpr double min_distance = 1e-2;
constexpr int max_iterations = 64;

using Label = std::uint64_t;

/// A hash of a number: the finalizer of splitmix64.
Label hashed(Label value) {
  value += 0x9e3779b97f4a7c15U;
  value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
  value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
  return value ^ (value >> 31U);
}

Label hashed(Label first, Label second) { return hashed(first ^ hashed(second)); }

Label on_grid(double length) { return static_cast<Label>(std::llround(length / resolution)); }

std::array<std::int64_t, 3> on_grid(const Eigen::Vector3d& point) {
  return {std::llround(point.x() / grid), std::llround(point.y() / grid), std::llround(point.z() / grid)};
}

/// The used vertices, relative to their centre and in units of their root mean square distance from it, and triangles.
struct Centred {
  std::vector<Eigen::Vector3d> positions;
  std::vector<SurfaceTriangle> faces;
};

/// Labels of the vertices that depend neither on the position of the surface nor on the numbering.
class Labels {
 public:
  explicit Labels(const Centred& surface) : surface_(surface) {
    labels_.reserve(surface.positions.size());
    for (const Eigen::Vector3d& at : surface.positions) labels_.push_back(hashed(on_grid(at.norm())));
    for (const SurfaceTriangle& face : surface.faces) {
      for (std::size_t k = 0; k < 3; ++k)
        sides_.push_back(on_grid((position(face[k]) - position(face[(k + 1) % 3])).norm()));
    }
    refine();
  }

  /// Distinguishes one vertex from all others.
  void mark(std::size_t vertex) {
    labels_[vertex] = hashed(labels_[vertex], 1);
    refine();
  }

  /// The vertex whose label the fewest others have, among those at least `min_distance` away from the line through the
  /// centre with direction `line` (from the centre if it is zero). Ties are broken by the largest distance from the
  /// centre, then by the smallest label, then by the largest x, y and z. `none` if there is no such vertex.
  std::size_t most_distinct(const Eigen::Vector3d& line) const {
    std::unordered_map<Label, std::size_t, SeededHash> counts;
    for (const Label label : labels_) ++counts[label];
    std::size_t best = none;
    const auto rank = [&](std::size_t i) {
      const Eigen::Vector3d& at = surface_.positions[i];
      const auto grid_point = on_grid(at);
      return std::tuple(counts.at(labels_[i]), -static_cast<std::int64_t>(on_grid(at.norm())), labels_[i],
                        -grid_point[0], -grid_point[1], -grid_point[2]);
    };
    for (std::size_t i = 0; i < labels_.size(); ++i) {
      const Eigen::Vector3d& at = surface_.positions[i];
      if ((at - line.dot(at) * line).norm() < min_distance) continue;
      if (best == none || rank(i) < rank(best)) best = i;
    }
    return best;
  }

  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

 private:
  const Eigen::Vector3d& position(std::int32_t vertex) const {
    return surface_.positions[static_cast<std::size_t>(vertex)];
  }

  std::size_t distinct_labels() const {
    std::vector<Label> all = labels_;
    std::ranges::sort(all);
    return static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
  }

  /// Combines each label with those of its neighbours, until this distinguishes no more vertices.
  void refine() {
    std::size_t distinct = distinct_labels();
    for (int iteration = 0; iteration < max_iterations && distinct < labels_.size(); ++iteration) {
      // Sums do not depend on the order of the triangles.
      std::vector<Label> sums(labels_.size(), 0);
      for (std::size_t f = 0; f < surface_.faces.size(); ++f) {
        const SurfaceTriangle& face = surface_.faces[f];
        for (std::size_t k = 0; k < 3; ++k) {
          const auto label = [&](std::size_t of) { return labels_[static_cast<std::size_t>(face[(k + of) % 3])]; };
          const auto side = [&](std::size_t of) { return sides_[3 * f + (k + of) % 3]; };
          sums[static_cast<std::size_t>(face[k])] +=
              hashed(hashed(label(1), side(0)), hashed(hashed(label(2), side(2)), side(1)));
        }
      }
      for (std::size_t i = 0; i < labels_.size(); ++i) labels_[i] = hashed(labels_[i], sums[i]);
      const std::size_t new_distinct = distinct_labels();
      if (new_distinct == distinct) return;
      distinct = new_distinct;
    }
  }

  const Centred& surface_;
  std::vector<Label> sides_;  ///< rounded lengths of each triangle's sides, from each corner to the next
  std::vector<Label> labels_;
};

/// Six times the enclosed volume, negative if the triangles are clockwise seen from outside.
double six_volumes(const Centred& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.faces) {
    const auto at = [&](std::int32_t vertex) { return surface.positions[static_cast<std::size_t>(vertex)]; };
    sum += at(a).dot(at(b).cross(at(c)));
  }
  return sum;
}

/// The given surface without vertices that no triangle uses. Its centre, unit of length and vertices are put into
/// `frame`.
Centred centred(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                CanonicalSurface& frame) {
  std::vector<std::int32_t> numbers(positions.size(), -1);
  for (const SurfaceTriangle& face : faces)
    for (const std::int32_t vertex : face) numbers[static_cast<std::size_t>(vertex)] = 0;
  frame.centre.setZero();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (numbers[i] < 0) continue;
    numbers[i] = static_cast<std::int32_t>(frame.vertices.size());
    frame.vertices.push_back(static_cast<std::int32_t>(i));
    frame.centre += positions[i];
  }
  const auto n = static_cast<double>(frame.vertices.size());
  frame.centre /= n;
  double squares = 0;
  for (const std::int32_t i : frame.vertices)
    squares += (positions[static_cast<std::size_t>(i)] - frame.centre).squaredNorm();
  frame.length = squares > 0 ? std::sqrt(squares / n) : 1;
  Centred surface;
  for (const std::int32_t i : frame.vertices)
    surface.positions.emplace_back((positions[static_cast<std::size_t>(i)] - frame.centre) / frame.length);
  for (const auto& [a, b, c] : faces)
    surface.faces.push_back({numbers[static_cast<std::size_t>(a)], numbers[static_cast<std::size_t>(b)],
                             numbers[static_cast<std::size_t>(c)]});
  if (six_volumes(surface) < 0)
    for (SurfaceTriangle& face : surface.faces) std::swap(face[1], face[2]);
  return surface;
}

/// The rotation into the frame that the centre and two vertices define; the identity if no two vertices can.
Eigen::Matrix3d rotation_of(const Centred& surface) {
  Labels labels(surface);
  const std::size_t first = labels.most_distinct(Eigen::Vector3d::Zero());
  if (first == Labels::none) return Eigen::Matrix3d::Identity();
  labels.mark(first);
  const Eigen::Vector3d x = surface.positions[first].normalized();
  const std::size_t second = labels.most_distinct(x);
  if (second == Labels::none) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d z = x.cross(surface.positions[second]).normalized();
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), z.cross(x).transpose(), z.transpose();
  return rotation;
}

}  // namespace

CanonicalSurface canonical_surface(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces) {
  CanonicalSurface result;
  const Centred surface = centred(positions, faces, result);
  result.rotation = rotation_of(surface);
  struct Vertex {
    std::array<std::int64_t, 3> grid_point;
    std::int32_t centred;
  };
  std::vector<Vertex> order;
  order.reserve(surface.positions.size());
  for (std::size_t i = 0; i < surface.positions.size(); ++i)
    order.push_back({on_grid(result.rotation * surface.positions[i]), static_cast<std::int32_t>(i)});
  std::ranges::sort(order, {}, [](const Vertex& vertex) { return std::tuple(vertex.grid_point, vertex.centred); });
  std::vector<std::int32_t> numbers(order.size());
  std::vector<std::int32_t> given;
  given.reserve(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto& [grid_point, vertex] = order[i];
    numbers[static_cast<std::size_t>(vertex)] = static_cast<std::int32_t>(i);
    given.push_back(result.vertices[static_cast<std::size_t>(vertex)]);
    result.positions.push_back(grid * Eigen::Vector3d(static_cast<double>(grid_point[0]),
                                                      static_cast<double>(grid_point[1]),
                                                      static_cast<double>(grid_point[2])));
  }
  result.vertices = std::move(given);
  for (const SurfaceTriangle& face : surface.faces) {
    SurfaceTriangle corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = numbers[static_cast<std::size_t>(face[k])];
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.faces.push_back(corners);
  }
  std::ranges::sort(result.faces);
  return result;
}

}  // namespace supple::meshing
