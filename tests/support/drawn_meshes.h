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

/// The rows of a drawing from top to bottom. Each '#' is a solid rectangle of two quadratic triangles.
using Drawing = std::vector<std::string>;

/// The drawing as a periodic mesh. `columns` are the rectangles' widths from left to right, `rows` their heights from
/// bottom to top; `skew` is a linear map of the plane.
inline tiling::PeriodicMesh draw(const Drawing& drawing, const std::vector<double>& columns,
                                 const std::vector<double>& rows,
                                 const Eigen::Matrix2d& skew = Eigen::Matrix2d::Identity()) {
  const int nx = static_cast<int>(columns.size());
  const int ny = static_cast<int>(rows.size());
  const auto solid = [&](int i, int j) {
    return drawing[static_cast<std::size_t>(ny - 1 - (j + ny) % ny)][static_cast<std::size_t>((i + nx) % nx)] == '#';
  };
  // Coordinates of the grid lines and of the lines in the middle between them.
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

/// A wall of width 1 that fills the height of the cell, and a gap between the wall and its next periodic image.
inline tiling::PeriodicMesh wall(double gap, int rows, double height = 2) {
  return draw(Drawing(static_cast<std::size_t>(rows), "##."), {0.5, 0.5, gap}, equal(rows, height / rows));
}

/// A bar with teeth that interlock with those of its next periodic image. Two pieces cross the border of the cell.
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

/// The same periodic pattern with another lattice basis: `times` the first translation is added to the second one, so
/// that neighbouring images are many cells apart.
inline tiling::PeriodicMesh redescribe(tiling::PeriodicMesh mesh, int times) {
  mesh.lattice.col(1) += times * mesh.lattice.col(0);
  for (auto& shifts : mesh.shifts)
    for (tiling::LatticeShift& shift : shifts)
      shift.first = static_cast<std::int8_t>(shift.first - times * shift.second);
  return mesh;
}

/// A random change of x, which moves points in waves of about `amplitude` and changes F by about `strain`.
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

/// Distance of the origin from a segment. The foot of the perpendicular is clamped to the segment.
inline double distance_to(const Eigen::Vector2d& tail, const Eigen::Vector2d& head) {
  const Eigen::Vector2d side = head - tail;
  const double squared = side.squaredNorm();
  const double share = squared > 0 ? std::min(1.0, std::max(0.0, -tail.dot(side) / squared)) : 0.0;
  return (tail + share * side).norm();
}

/// The images of all points in a state, at most `first` and `second` cells away along the lattice's translations. They
/// are plain numbers because tests compare millions of them.
class Images {
 public:
  Images(const ContactOutline& outline, const Eigen::VectorXd& x, int first, int second)
      : first_(first), second_(second), positions_(static_cast<std::size_t>(outline.points())) {
    for (const auto& segment : outline.segments) {
      first_ = std::max(first_, first + std::abs(segment.head_shift[0]));
      second_ = std::max(second_, second + std::abs(segment.head_shift[1]));
    }
    const Eigen::Matrix2d f = CellCoordinates{(x.size() - 4) / 2}.deformation_gradient(x);
    for (int p = 0; p < outline.points(); ++p)
      for (int i = -first_; i <= first_; ++i)
        for (int j = -second_; j <= second_; ++j) {
          const Eigen::Vector2d rest = outline.rest.col(p) + outline.lattice * Eigen::Vector2d(i, j);
          const Eigen::Vector2d at = f * rest + x.segment<2>(2 * outline.nodes[static_cast<std::size_t>(p)]);
          positions_[static_cast<std::size_t>(p)].push_back({at[0], at[1]});
        }
  }
  const std::array<double, 2>& at(int point, int i, int j) const {
    const int image = (i + first_) * (2 * second_ + 1) + j + second_;
    return positions_[static_cast<std::size_t>(point)].at(static_cast<std::size_t>(image));
  }

 private:
  int first_;
  int second_;
  std::vector<std::vector<std::array<double, 2>>> positions_;
};

using PairKey = std::tuple<int, int, int, int>;

/// All pairs of a point and a segment within their range at x, as the point's node, the segment and the image. They are
/// found by testing all pairs with images up to `first` and `second` cells away.
inline std::set<PairKey> brute_contacts(const ContactOutline& outline, const Eigen::VectorXd& x, double range,
                                        double rest_fraction, int first, int second) {
  const Images now(outline, x, first, second);
  const Images before(outline, Eigen::VectorXd::Zero(x.size()), first, second);
  std::set<PairKey> contacts;
  for (int p = 0; p < outline.points(); ++p)
    for (int s = 0; s < static_cast<int>(outline.segments.size()); ++s)
      for (int i = -first; i <= first; ++i)
        for (int j = -second; j <= second; ++j) {
          const auto& segment = outline.segments[static_cast<std::size_t>(s)];
          const int head_i = i + segment.head_shift[0];
          const int head_j = j + segment.head_shift[1];
          if (segment.tail == p && i == 0 && j == 0) continue;
          if (segment.head == p && head_i == 0 && head_j == 0) continue;
          const auto distance = [&](const Images& images) {
            const auto& o = images.at(p, 0, 0);
            const auto& a = images.at(segment.tail, i, j);
            const auto& b = images.at(segment.head, head_i, head_j);
            return distance_to({a[0] - o[0], a[1] - o[1]}, {b[0] - o[0], b[1] - o[1]});
          };
          const double d = distance(now);
          if (d >= range || d >= rest_fraction * distance(before)) continue;
          contacts.emplace(outline.nodes[static_cast<std::size_t>(p)], s, i, j);
        }
  return contacts;
}

/// Whether any two segments cross, including images, found by testing all pairs.
inline bool brute_intersects(const ContactOutline& outline, const Eigen::VectorXd& x, int images) {
  using Point = std::array<double, 2>;
  const auto turn = [](const Point& a, const Point& b, const Point& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  };
  const auto distance = [](const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); };
  // For disjoint segments on one line, the signs of the orientations are mere rounding.
  const auto apart = [](const Point& a, const Point& b, const Point& c, const Point& d, std::size_t k) {
    return std::max(a[k], b[k]) < std::min(c[k], d[k]) || std::max(c[k], d[k]) < std::min(a[k], b[k]);
  };
  const Images now(outline, x, images, images);
  for (const auto& first : outline.segments) {
    const Point& a = now.at(first.tail, 0, 0);
    const Point& b = now.at(first.head, first.head_shift[0], first.head_shift[1]);
    for (const auto& second : outline.segments)
      for (int i = -images; i <= images; ++i)
        for (int j = -images; j <= images; ++j) {
          const Point& c = now.at(second.tail, i, j);
          const Point& d = now.at(second.head, i + second.head_shift[0], j + second.head_shift[1]);
          if (apart(a, b, c, d, 0) || apart(a, b, c, d, 1)) continue;
          // Neighbouring segments have a common end.
          if (std::min({distance(a, c), distance(a, d), distance(b, c), distance(b, d)}) < 1e-13) continue;
          if (turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0) return true;
        }
  }
  return false;
}

}  // namespace supple::microscale::testing
