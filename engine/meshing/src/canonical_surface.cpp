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

/// Positions are rounded to this grid. Rounding errors of a turn, some 1e-16, rarely lead to another place on it.
constexpr double grid = 1.0 / (1 << 30);
/// Lengths that tell vertices apart are compared by so much, which leaves rounding errors far below.
constexpr double resolution = 1.0 / (1 << 22);
/// The vertices that make the frame are at least so far from the centre, and from the line through it and the first
/// one.
constexpr double min_distance = 1e-2;
constexpr int max_rounds = 64;

using Label = std::uint64_t;

/// A number that has nothing to do with that of other arguments (the finalizer of splitmix64).
Label mixed(Label value) {
  value += 0x9e3779b97f4a7c15U;
  value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
  value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
  return value ^ (value >> 31U);
}

Label mixed(Label first, Label second) { return mixed(first ^ mixed(second)); }

Label on_grid(double length) { return static_cast<Label>(std::llround(length / resolution)); }

std::array<std::int64_t, 3> on_grid(const Eigen::Vector3d& point) {
  return {std::llround(point.x() / grid), std::llround(point.y() / grid), std::llround(point.z() / grid)};
}

/// The used vertices around their centre in units of their mean distance, and triangles of them.
struct Centred {
  std::vector<Eigen::Vector3d> positions;
  std::vector<SurfaceTriangle> faces;
};

/// Labels of the vertices that do not depend on position and numbers.
class Labels {
 public:
  explicit Labels(const Centred& surface) : surface_(surface) {
    labels_.reserve(surface.positions.size());
    for (const Eigen::Vector3d& at : surface.positions) labels_.push_back(mixed(on_grid(at.norm())));
    for (const SurfaceTriangle& face : surface.faces) {
      for (std::size_t k = 0; k < 3; ++k)
        sides_.push_back(on_grid((position(face[k]) - position(face[(k + 1) % 3])).norm()));
    }
    refine();
  }

  /// Tells one vertex from all others.
  void mark(std::size_t vertex) {
    labels_[vertex] = mixed(labels_[vertex], 1);
    refine();
  }

  /// The vertex at least so far from a line through the centre (of no direction: from the centre) that shares its label
  /// with the fewest others; of these the farthest from the centre; of these that of the least label. Of those that are
  /// still alike, the one farthest along x, y and z. `none` if there is no such vertex.
  std::size_t most_distinct(const Eigen::Vector3d& line) const {
    std::unordered_map<Label, std::size_t, SeededHash> counts;
    for (const Label label : labels_) ++counts[label];
    std::size_t best = none;
    const auto rank = [&](std::size_t i) {
      const Eigen::Vector3d& at = surface_.positions[i];
      const auto place = on_grid(at);
      return std::tuple(counts.at(labels_[i]), -static_cast<std::int64_t>(on_grid(at.norm())), labels_[i], -place[0],
                        -place[1], -place[2]);
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

  std::size_t count() const {
    std::vector<Label> all = labels_;
    std::ranges::sort(all);
    return static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin());
  }

  /// Each label takes those of its neighbours into account, until this tells no more vertices apart.
  void refine() {
    std::size_t known = count();
    for (int round = 0; round < max_rounds && known < labels_.size(); ++round) {
      // Sums do not depend on the order of the triangles.
      std::vector<Label> sums(labels_.size(), 0);
      for (std::size_t f = 0; f < surface_.faces.size(); ++f) {
        const SurfaceTriangle& face = surface_.faces[f];
        for (std::size_t k = 0; k < 3; ++k) {
          const auto label = [&](std::size_t of) { return labels_[static_cast<std::size_t>(face[(k + of) % 3])]; };
          const auto side = [&](std::size_t of) { return sides_[3 * f + (k + of) % 3]; };
          sums[static_cast<std::size_t>(face[k])] +=
              mixed(mixed(label(1), side(0)), mixed(mixed(label(2), side(2)), side(1)));
        }
      }
      for (std::size_t i = 0; i < labels_.size(); ++i) labels_[i] = mixed(labels_[i], sums[i]);
      const std::size_t now = count();
      if (now == known) return;
      known = now;
    }
  }

  const Centred& surface_;
  std::vector<Label> sides_;  ///< of each triangle, from each corner to the next
  std::vector<Label> labels_;
};

double six_volumes(const Centred& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.faces) {
    const auto at = [&](std::int32_t vertex) { return surface.positions[static_cast<std::size_t>(vertex)]; };
    sum += at(a).dot(at(b).cross(at(c)));
  }
  return sum;
}

/// The given surface without vertices that no triangle uses, around the centre and in the unit that `frame` receives.
Centred centred(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces,
                CanonicalSurface& frame) {
  std::vector<std::int32_t> number(positions.size(), -1);
  for (const SurfaceTriangle& face : faces)
    for (const std::int32_t vertex : face) number[static_cast<std::size_t>(vertex)] = 0;
  frame.centre.setZero();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<std::int32_t>(frame.vertices.size());
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
    surface.faces.push_back({number[static_cast<std::size_t>(a)], number[static_cast<std::size_t>(b)],
                             number[static_cast<std::size_t>(c)]});
  if (six_volumes(surface) < 0)
    for (SurfaceTriangle& face : surface.faces) std::swap(face[1], face[2]);
  return surface;
}

/// Two vertices and the centre make it; the given frame where no two do.
Eigen::Matrix3d turn_of(const Centred& surface) {
  Labels labels(surface);
  const std::size_t first = labels.most_distinct(Eigen::Vector3d::Zero());
  if (first == Labels::none) return Eigen::Matrix3d::Identity();
  labels.mark(first);
  const Eigen::Vector3d x = surface.positions[first].normalized();
  const std::size_t second = labels.most_distinct(x);
  if (second == Labels::none) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d z = x.cross(surface.positions[second]).normalized();
  Eigen::Matrix3d turn;
  turn << x.transpose(), z.cross(x).transpose(), z.transpose();
  return turn;
}

}  // namespace

CanonicalSurface canonical_surface(std::span<const Eigen::Vector3d> positions, std::span<const SurfaceTriangle> faces) {
  CanonicalSurface result;
  const Centred surface = centred(positions, faces, result);
  result.turn = turn_of(surface);
  struct Vertex {
    std::array<std::int64_t, 3> place;
    std::int32_t centred;
  };
  std::vector<Vertex> order;
  order.reserve(surface.positions.size());
  for (std::size_t i = 0; i < surface.positions.size(); ++i)
    order.push_back({on_grid(result.turn * surface.positions[i]), static_cast<std::int32_t>(i)});
  std::ranges::sort(order, {}, [](const Vertex& vertex) { return std::tuple(vertex.place, vertex.centred); });
  std::vector<std::int32_t> number(order.size());
  std::vector<std::int32_t> given;
  given.reserve(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto& [place, vertex] = order[i];
    number[static_cast<std::size_t>(vertex)] = static_cast<std::int32_t>(i);
    given.push_back(result.vertices[static_cast<std::size_t>(vertex)]);
    result.positions.push_back(grid * Eigen::Vector3d(static_cast<double>(place[0]), static_cast<double>(place[1]),
                                                      static_cast<double>(place[2])));
  }
  result.vertices = std::move(given);
  for (const SurfaceTriangle& face : surface.faces) {
    SurfaceTriangle corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = number[static_cast<std::size_t>(face[k])];
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    result.faces.push_back(corners);
  }
  std::ranges::sort(result.faces);
  return result;
}

}  // namespace supple::meshing
