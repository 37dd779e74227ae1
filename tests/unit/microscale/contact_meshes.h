#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "cell_coordinates.h"
#include "contact_outline.h"
#include "supple/base/random.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale::testing {

/// Rows of a drawing from top to bottom, '#' for solid: each character is a rectangle of two quadratic triangles.
using Drawing = std::vector<std::string>;

/// The drawing as a periodic mesh. `columns` and `rows` are the rectangles' widths from the left and heights from the
/// bottom; `skew` maps the whole plane.
inline tiling::PeriodicMesh draw(const Drawing& drawing, const std::vector<double>& columns,
                                 const std::vector<double>& rows,
                                 const Eigen::Matrix2d& skew = Eigen::Matrix2d::Identity()) {
  const int nx = static_cast<int>(columns.size());
  const int ny = static_cast<int>(rows.size());
  const auto solid = [&](int i, int j) {
    return drawing[static_cast<std::size_t>(ny - 1 - (j + ny) % ny)][static_cast<std::size_t>((i + nx) % nx)] == '#';
  };
  // Coordinates of lines and midlines.
  const auto lines = [](const std::vector<double>& widths) {
    std::vector<double> at{0};
    for (const double width : widths) {
      const double start = at.back();
      at.push_back(start + width / 2);
      at.push_back(start + width);
    }
    return at;
  };
  const std::vector<double> x = lines(columns);
  const std::vector<double> y = lines(rows);

  tiling::PeriodicMesh mesh;
  mesh.lattice = skew * Eigen::Vector2d(x.back(), y.back()).asDiagonal();
  std::map<std::pair<int, int>, int> nodes;
  std::vector<Eigen::Vector2d> positions;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (!solid(i, j)) continue;
      const std::pair<int, int> corner[4] = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
      const int triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
      const bool outer[2][3] = {{!solid(i, j - 1), !solid(i + 1, j), false},
                                {false, !solid(i, j + 1), !solid(i - 1, j)}};
      for (int t = 0; t < 2; ++t) {
        std::array<int, 6> triangle{};
        std::array<tiling::LatticeShift, 6> shifts{};
        for (std::size_t k = 0; k < 6; ++k) {
          const auto& a = corner[triangles[t][k % 3]];
          const auto& b = corner[triangles[t][k < 3 ? k : (k + 1) % 3]];
          const int u = 2 * i + (a.first + b.first) / 2;
          const int v = 2 * j + (a.second + b.second) / 2;
          const auto [found, fresh] = nodes.emplace(std::pair(u % (2 * nx), v % (2 * ny)), positions.size());
          if (fresh)
            positions.emplace_back(skew * Eigen::Vector2d(x[static_cast<std::size_t>(u % (2 * nx))],
                                                          y[static_cast<std::size_t>(v % (2 * ny))]));
          triangle[k] = found->second;
          shifts[k] = {static_cast<std::int8_t>(u / (2 * nx)), static_cast<std::int8_t>(v / (2 * ny))};
        }
        for (int side = 0; side < 3; ++side)
          if (outer[t][side]) mesh.outline.push_back({static_cast<int>(mesh.triangles.size()), side});
        mesh.triangles.push_back(triangle);
        mesh.shifts.push_back(shifts);
      }
    }
  mesh.nodes.resize(2, static_cast<Eigen::Index>(positions.size()));
  for (std::size_t k = 0; k < positions.size(); ++k) mesh.nodes.col(static_cast<Eigen::Index>(k)) = positions[k];
  mesh.beam_width = 1;
  return mesh;
}

inline std::vector<double> equal(int count, double width) {
  return std::vector<double>(static_cast<std::size_t>(count), width);
}

/// A wall of width 1 that fills the height, and a gap to its own next image.
inline tiling::PeriodicMesh wall(double gap, int rows, double height = 2) {
  return draw(Drawing(static_cast<std::size_t>(rows), "##."), {0.5, 0.5, gap}, equal(rows, height / rows));
}

/// Teeth on a bar that interlock with those of the next image; two pieces cross the cell's border.
inline tiling::PeriodicMesh comb(const Eigen::Matrix2d& skew = Eigen::Matrix2d::Identity()) {
  return draw({"..######..",  //
               "..#....#..",  //
               "###.##.###",  //
               "....##....",  //
               "##########",  //
               ".........."},
              equal(10, 0.2), equal(6, 0.25), skew);
}

/// An open ring.
inline tiling::PeriodicMesh open_ring() {
  return draw({"......",  //
               ".####.",  //
               ".#..#.",  //
               ".#....",  //
               ".#..#.",  //
               ".####."},
              {0.1, 0.3, 0.4, 0.4, 0.3, 0.1}, {0.3, 0.3, 0.05, 0.3, 0.3, 0.1});
}

/// A change of x whose points wave about by about `amplitude`, and F by about `strain`.
inline Eigen::VectorXd random_motion(const tiling::PeriodicMesh& mesh, double amplitude, double strain,
                                     RandomStream& random) {
  const CellCoordinates coordinates{mesh.nodes.cols()};
  Eigen::VectorXd step = Eigen::VectorXd::Zero(coordinates.size());
  const Eigen::Matrix2d inverse = mesh.lattice.inverse();
  for (int wave = 0; wave < 4; ++wave) {
    const Eigen::RowVector2d number(random.below(5) - 2, random.below(5) - 2);
    const Eigen::Vector2d direction(random.normal(), random.normal());
    const double phase = random.uniform(0, 6.3);
    for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
      step.segment<2>(2 * k) +=
          amplitude / 2 * std::cos(6.283185307179586 * number.dot(inverse * mesh.nodes.col(k)) + phase) * direction;
  }
  for (Eigen::Index k = 0; k < 2 * mesh.nodes.cols(); ++k) step[k] += 0.05 * amplitude * random.normal();
  for (int k = 0; k < 4; ++k) step[coordinates.strain() + k] = strain * random.normal();
  return step;
}

/// Every point with every image of a segment around, written down independently of the search.
struct BrutePair {
  int point = 0;
  int segment = 0;
  Eigen::Vector2i shift;
  Eigen::Vector2d tail, head;            ///< seen from the point at x
  Eigen::Vector2d rest_tail, rest_head;  ///< and at rest
};
template <class Visitor>
void for_all_pairs(const ContactOutline& outline, const Eigen::VectorXd& x, int images, Visitor&& visitor) {
  const Eigen::Matrix2d f = CellCoordinates{(x.size() - 4) / 2}.deformation_gradient(x);
  const auto displacement = [&](int point) { return x.segment<2>(2 * outline.nodes[static_cast<std::size_t>(point)]); };
  BrutePair pair;
  for (pair.point = 0; pair.point < outline.points(); ++pair.point)
    for (pair.segment = 0; pair.segment < static_cast<int>(outline.segments.size()); ++pair.segment)
      for (pair.shift[0] = -images; pair.shift[0] <= images; ++pair.shift[0])
        for (pair.shift[1] = -images; pair.shift[1] <= images; ++pair.shift[1]) {
          const auto& segment = outline.segments[static_cast<std::size_t>(pair.segment)];
          const Eigen::Vector2i head_shift = pair.shift + segment.head_shift;
          if ((segment.tail == pair.point && pair.shift.isZero()) ||
              (segment.head == pair.point && head_shift.isZero()))
            continue;
          pair.rest_tail = outline.rest.col(segment.tail) + outline.lattice * pair.shift.cast<double>() -
                           outline.rest.col(pair.point);
          pair.rest_head = outline.rest.col(segment.head) + outline.lattice * head_shift.cast<double>() -
                           outline.rest.col(pair.point);
          pair.tail = f * pair.rest_tail + displacement(segment.tail) - displacement(pair.point);
          pair.head = f * pair.rest_head + displacement(segment.head) - displacement(pair.point);
          visitor(pair);
        }
}

/// Distance of the origin from a segment, by clamping the foot of the perpendicular.
inline double distance_to(const Eigen::Vector2d& tail, const Eigen::Vector2d& head) {
  const Eigen::Vector2d side = head - tail;
  const double squared = side.squaredNorm();
  const double share = squared > 0 ? std::min(1.0, std::max(0.0, -tail.dot(side) / squared)) : 0.0;
  return (tail + share * side).norm();
}

using PairKey = std::tuple<int, int, int, int>;

/// Node of the point, segment and image of all pairs within their range at x.
inline std::set<PairKey> brute_contacts(const ContactOutline& outline, const Eigen::VectorXd& x, double range,
                                        double rest_fraction, int images) {
  std::set<PairKey> contacts;
  for_all_pairs(outline, x, images, [&](const BrutePair& pair) {
    const double own = std::min(range, rest_fraction * distance_to(pair.rest_tail, pair.rest_head));
    if (distance_to(pair.tail, pair.head) < own)
      contacts.emplace(outline.nodes[static_cast<std::size_t>(pair.point)], pair.segment, pair.shift[0], pair.shift[1]);
  });
  return contacts;
}

/// Whether two segments cross, images included, by testing all of them.
inline bool brute_intersects(const ContactOutline& outline, const Eigen::VectorXd& x, int images) {
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  };
  const Eigen::Matrix2d f = CellCoordinates{(x.size() - 4) / 2}.deformation_gradient(x);
  const auto position = [&](int point, const Eigen::Vector2i& shift) -> Eigen::Vector2d {
    return f * (outline.rest.col(point) + outline.lattice * shift.cast<double>()) +
           x.segment<2>(2 * outline.nodes[static_cast<std::size_t>(point)]);
  };
  const Eigen::Vector2i here = Eigen::Vector2i::Zero();
  for (const auto& first : outline.segments) {
    const Eigen::Vector2d a = position(first.tail, here);
    const Eigen::Vector2d b = position(first.head, first.head_shift);
    for (const auto& second : outline.segments)
      for (int i = -images; i <= images; ++i)
        for (int j = -images; j <= images; ++j) {
          const Eigen::Vector2i shift(i, j);
          const Eigen::Vector2d c = position(second.tail, shift);
          const Eigen::Vector2d d = position(second.head, shift + second.head_shift);
          // Neighbours meet in their common end.
          const double together = std::min({(a - c).norm(), (a - d).norm(), (b - c).norm(), (b - d).norm()});
          if (together < 1e-13) continue;
          // Rounding tells nothing about segments on one line: those lie behind each other.
          if (((a + b - c - d).norm() > (a - b).norm() + (c - d).norm())) continue;
          if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return true;
        }
  }
  return false;
}

}  // namespace supple::microscale::testing
