#include "size_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "polygon.h"

namespace supple::tiling {
namespace {

/// Angle of a hole (rad) from which on stress hardly concentrates at the corner of the solid.
constexpr double flat_angle = 11.0 / 12 * std::numbers::pi;

/// Tolerance of the number of parts into which a side is divided, so that rounding decides nothing if its length is a
/// multiple of the size.
constexpr double count_tolerance = 1e-6;

/// Steps by which the density of nodes along a segment is integrated, for each of the smallest wanted lengths.
constexpr double steps_per_side = 8;

/// The square of side `side` in which a point lies.
std::pair<int, int> square_of(const Eigen::Vector2d& p, double side) {
  return {static_cast<int>(std::floor(p.x() / side)), static_cast<int>(std::floor(p.y() / side))};
}

int count_of(double sides) { return std::max(1, static_cast<int>(std::ceil(sides - count_tolerance))); }

/// Ratio of a triangle's area to its squared wanted side; gmsh's triangles are close to equilateral.
constexpr double area_per_square = std::numbers::sqrt3 / 4;
constexpr double nodes_per_triangle = 2;  // of quadratic triangles, in the limit of many

}  // namespace

SizeField::SizeField(const MeshOptions& options, double beam_width)
    : size_(options.mesh_size * beam_width), corner_size_(options.corner_size), radius_(beam_width / 2) {}

void SizeField::add_corners(const Polygon& hole) {
  const std::size_t n = hole.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::Vector2d in = hole[k] - hole[(k + n - 1) % n], out = hole[(k + 1) % n] - hole[k];
    const double turn = std::atan2(cross(in, out), in.dot(out));
    if (std::numbers::pi - turn < flat_angle) corners_.push_back(hole[k]);
  }
}

void SizeField::repeat_corners(const Eigen::Matrix2d& lattice, const Eigen::Vector2d& origin) {
  const Eigen::Matrix2d inverse = lattice.inverse();
  // The largest change of the lattice coordinates over the distance `radius_`.
  const Eigen::Vector2d reach = radius_ * inverse.rowwise().norm();
  std::vector<Eigen::Vector2d> translates;
  for (const Eigen::Vector2d& corner : corners_) {
    const Eigen::Vector2d at = inverse * (corner - origin);
    const Eigen::Vector2i first = (-reach - at).array().ceil().cast<int>();
    for (int i = first[0]; at[0] + i <= 1 + reach[0]; ++i) {
      for (int j = first[1]; at[1] + j <= 1 + reach[1]; ++j) {
        translates.emplace_back(corner + lattice * Eigen::Vector2d(i, j));
      }
    }
  }
  corners_ = std::move(translates);
}

void SizeField::index_corners() {
  squares_.clear();
  for (const Eigen::Vector2d& corner : corners_) squares_[square_of(corner, radius_)].push_back(corner);
}

double SizeField::operator()(const Eigen::Vector2d& p) const {
  if (corner_size_ == 1) return size_;
  double squared = radius_ * radius_;
  const auto include = [&](const std::vector<Eigen::Vector2d>& corners) {
    for (const Eigen::Vector2d& corner : corners) squared = std::min(squared, (p - corner).squaredNorm());
  };
  if (squares_.empty()) {
    include(corners_);
  } else {
    const auto [i, j] = square_of(p, radius_);
    for (int di = -1; di <= 1; ++di)
      for (int dj = -1; dj <= 1; ++dj)
        if (const auto found = squares_.find({i + di, j + dj}); found != squares_.end()) include(found->second);
  }
  return size_ * (corner_size_ + (1 - corner_size_) * std::sqrt(squared) / radius_);
}

double SizeField::expected_nodes(double solid_area, double corners) const {
  double triangles = solid_area / (area_per_square * size_ * size_);
  if (corner_size_ < 1) {
    // This is the integral of 2 pi r dr / size(r)^2 over the discs around corners, without a quarter disc for the hole.
    const double c = corner_size_;
    const double integral = (std::log(1 / c) + c - 1) / ((1 - c) * (1 - c));
    triangles += corners * 1.5 * std::numbers::pi * radius_ * radius_ * integral / (area_per_square * size_ * size_);
  }
  return nodes_per_triangle * triangles;
}

std::vector<Eigen::Vector2d> SizeField::divide(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
  if (corner_size_ == 1 || corners_.empty()) return divide_equally(a, b, size_);
  const double length = (b - a).norm();
  const int steps = count_of(steps_per_side * length / (size_ * corner_size_));
  // sides[k] is the number of sides that fit between a and the k-th step, by the trapezoidal rule.
  std::vector<double> sides = {0};
  double before = 1 / (*this)(a);
  for (int k = 1; k <= steps; ++k) {
    const double here = 1 / (*this)(a + (b - a) * k / steps);
    sides.push_back(sides.back() + (before + here) / 2 * length / steps);
    before = here;
  }
  const int count = count_of(sides.back());
  std::vector<Eigen::Vector2d> points;
  int step = 0;
  for (int k = 1; k < count; ++k) {
    const double wanted = sides.back() * k / count;
    while (sides[step + 1] < wanted) ++step;
    const double t = (step + (wanted - sides[step]) / (sides[step + 1] - sides[step])) / steps;
    points.emplace_back(a + t * (b - a));
  }
  return points;
}

std::vector<Eigen::Vector2d> divide_equally(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double size) {
  const int count = count_of((b - a).norm() / size);
  std::vector<Eigen::Vector2d> points;
  for (int k = 1; k < count; ++k) points.emplace_back(((count - k) * a + k * b) / count);
  return points;
}

}  // namespace supple::tiling
