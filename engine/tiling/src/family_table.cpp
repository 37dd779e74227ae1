#include "family_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple::tiling {
namespace {

constexpr Affine p1 = Affine::parameter(0);
constexpr Affine p2 = Affine::parameter(1);
constexpr Affine p3 = Affine::parameter(2);
constexpr Affine p4 = Affine::parameter(3);

constexpr double cos60 = 0.5;
constexpr double sin60 = std::numbers::sqrt3 / 2;

// The linear parts of placements, row by row. Rotations are counterclockwise, by degrees.
constexpr std::array<double, 4> identity = {1, 0, 0, 1};
constexpr std::array<double, 4> rotation60 = {cos60, -sin60, sin60, cos60};
constexpr std::array<double, 4> rotation90 = {0, -1, 1, 0};
constexpr std::array<double, 4> rotation120 = {-cos60, -sin60, sin60, -cos60};
constexpr std::array<double, 4> rotation180 = {-1, 0, 0, -1};
constexpr std::array<double, 4> rotation240 = {-cos60, sin60, -sin60, -cos60};
constexpr std::array<double, 4> rotation270 = {0, 1, -1, 0};
constexpr std::array<double, 4> rotation300 = {cos60, sin60, -sin60, cos60};
constexpr std::array<double, 4> mirror_x = {-1, 0, 0, 1};        // x changes sign
constexpr std::array<double, 4> mirror_y = {1, 0, 0, -1};        // y changes sign
constexpr std::array<double, 4> mirror_diagonal = {0, 1, 1, 0};  // x and y change places

/// Length below which sides of the square family's tiles are points, in tiling units: some 1e-8 beam widths.
constexpr double min_tile_side = 1e-9;

void add_hexagons(std::vector<IsohedralType>& table) {
  table.push_back(
      {.id = "IH01",
       .description = "Hexagons whose opposite edges are parallel; one tile per cell",
       .parameters = {{0.05, 0.3, 0.1223975049}, {0.25, 0.75, 0.5}, {0.05, 0.15, 0.143395479}, {0.4, 0.8, 0.625}},
       .beam_width = 0.1282,
       .tile = {{0, 0},
                {3.9 * p1 + 0.1, 5 * p2 - 2.5},
                {3.9 * p1 + 5.5 * p3 - 0.4, 5 * p2 - 4 * p4 + 0.5},
                {3.9 * p1 + 0.1, 5 * p2 - 1.5},
                {0, 1},
                {-5.5 * p3 + 0.5, 4 * p4 - 2}},
       .translations = {{{0, -1}, {3.9 * p1 + 5.5 * p3 - 0.4, 5 * p2 - 4 * p4 - 0.5}}},
       .placements = {{identity, {0, 0}}}});
}

void add_pentagons(std::vector<IsohedralType>& table) {
  // The bounds start above the type's own default of p1, 0.1045; the preset is the nearest value within them.
  table.push_back(
      {.id = "IH21",
       .description = "Pentagons around centres of sixfold, threefold and twofold rotation; six tiles per cell",
       .parameters = {{0.105, 0.195, 0.105}, {0.505, 0.795, 0.65}},
       .beam_width = 0.0641,
       .sufficient_mesh_size = 1,
       .tile = {{1, 0},
                {5 * p2 - 2.5, 5.1 * p1 - 0.1},
                {-5.1 / (2 * std::numbers::sqrt3) * p1 + 2.5 * p2 - 1.25 + 0.05 / std::numbers::sqrt3,
                 2.55 * p1 + 2.5 / std::numbers::sqrt3 * p2 - 1.25 / std::numbers::sqrt3 - 0.05},
                {0, 0},
                {0.5, -sin60}},
       .translations = {{{5.1 * sin60 * p1 - 2.5 * p2 + 2.75 - 0.1 * sin60,
                          -2.55 * p1 - 5 * sin60 * p2 + 1.5 * sin60 + 0.05},
                         {-5 * p2 + 2.5, -5.1 * p1 + 0.1 - 2 * sin60}}},
       .placements = {{identity, {0, 0}},
                      {rotation300, {1, 0}},
                      {rotation240, {1.5, -sin60}},
                      {rotation180, {1, -2 * sin60}},
                      {rotation120, {0, -2 * sin60}},
                      {rotation60, {-0.5, -sin60}}}});

  table.push_back({.id = "IH22",
                   .description = "Pentagons in mirrored pairs; two tiles per cell",
                   .parameters = {{0.1, 0.3, 0.2307692308}, {0.3, 0.7, 0.5}, {0, 0.3, 0.2253357527}},
                   .beam_width = 0.0897,
                   .tile = {{3.9 * p1 + 0.1, 5 * p2 - 2.5},
                            {3.9 * p1 + 3.5 * p3 - 0.4, 5 * p2 - 2},
                            {3.9 * p1 + 0.1, 5 * p2 - 1.5},
                            {0, 1},
                            {0, 0}},
                   .translations = {{{-7.8 * p1 - 3.5 * p3 + 0.3, -0.5}, {-7.8 * p1 - 3.5 * p3 + 0.3, 0.5}}},
                   .placements = {{identity, {0, 0}}, {mirror_x, {0, 0}}}});

  table.push_back({.id = "IH28",
                   .description = "Pentagons around two centres of fourfold rotation; four tiles per cell",
                   .parameters = {{0.005, 0.8, 0.4528270266}, {0.005, 1, 0.5}},
                   .beam_width = 0.0769,
                   .sufficient_mesh_size = 1,
                   .tile = {{0, 1},
                            {0, 0},
                            {1.95 * p1 + 2.5 * p2 - 0.95, -1.95 * p1 + 2.5 * p2 - 1.05},
                            {3.9 * p1 + 0.1, 5 * p2 - 2},
                            {1.95 * p1 - 2.5 * p2 + 1.55, 1.95 * p1 + 2.5 * p2 - 0.45}},
                   .translations = {{{-3.9 * p1 + 5 * p2 - 3.1, -3.9 * p1 - 5 * p2 + 1.9},
                                     {-3.9 * p1 - 5 * p2 + 1.9, 3.9 * p1 - 5 * p2 + 3.1}}},
                   .placements = {{identity, {0, 0}},
                                  {rotation180, {0, 1}},
                                  {rotation90, {-3.9 * p1 - 0.1, -5 * p2 + 3}},
                                  {rotation270, {-3.9 * p1 - 1.1, -5 * p2 + 3}}}});

  table.push_back({.id = "IH29",
                   .description = "Pentagons in pairs around centres of fourfold rotation; four tiles per cell",
                   .parameters = {{0.005, 1, 0.3668738189}},
                   .beam_width = 0.1282,
                   .sufficient_mesh_size = 0.7,
                   .tile = {{-1, 0},
                            {1, 0},
                            {4.95 * p1 + 0.55, 4.95 * p1 + 0.55},
                            {0, 9.9 * p1 + 0.1},
                            {-4.95 * p1 - 0.55, 4.95 * p1 + 0.55}},
                   .translations = {{{9.9 * p1 + 1.1, -9.9 * p1 - 1.1}, {-9.9 * p1 - 1.1, -9.9 * p1 - 1.1}}},
                   .placements = {{identity, {0, 0}},
                                  {rotation180, {0, 0}},
                                  {rotation90, {9.9 * p1 + 1.1, 0}},
                                  {mirror_diagonal, {-9.9 * p1 - 1.1, 0}}}});
}

void add_quadrilaterals(std::vector<IsohedralType>& table) {
  table.push_back({.id = "IH50",
                   .description = "Quadrilaterals in zigzag rows; four tiles per cell",
                   .parameters = {{0.1, 0.3, 0.2307692308}, {0.25, 0.75, 0.5}},
                   .beam_width = 0.0385,
                   .tile = {{0, 0}, {3.9 * p1 + 0.1, 5 * p2 - 2.5}, {3.9 * p1 + 0.1, 5 * p2 - 1.5}, {0, 1}},
                   .translations = {{{-15.6 * p1 - 0.4, 0}, {0, -1}}},
                   .placements = {{identity, {0, 0}},
                                  {rotation180, {0, 1}},
                                  {mirror_x, {7.8 * p1 + 0.2, 0}},
                                  {mirror_y, {-7.8 * p1 - 0.2, 1}}}});

  table.push_back({.id = "IH67",
                   .description = "Symmetric trapezoids in rows; two tiles per cell",
                   .parameters = {{0.1, 0.3, 0.2307692308}, {0.6, 1.1, 0.8695652174}},
                   .beam_width = 0.0769,
                   .tile = {{1, 0}, {-3.45 * p2 + 4, 3.9 * p1 + 0.1}, {3.45 * p2 - 3, 3.9 * p1 + 0.1}, {0, 0}},
                   .translations = {{{-3.45 * p2 + 4, -3.9 * p1 - 0.1}, {-3.45 * p2 + 4, 3.9 * p1 + 0.1}}},
                   .placements = {{identity, {0, 0}}, {rotation180, {-3.45 * p2 + 5, 3.9 * p1 + 0.1}}}});
}

std::vector<IsohedralType> make_table() {
  std::vector<IsohedralType> table;
  add_hexagons(table);
  add_pentagons(table);
  add_quadrilaterals(table);
  return table;
}

// The polygon without vertices that coincide with the one before.
Polygon without_repetitions(const Polygon& polygon) {
  Polygon result;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Eigen::Vector2d& before = polygon[(k + polygon.size() - 1) % polygon.size()];
    if ((polygon[k] - before).norm() > min_tile_side) result.push_back(polygon[k]);
  }
  return result;
}

}  // namespace

const std::vector<IsohedralType>& isohedral_types() {
  static const std::vector<IsohedralType> table = make_table();
  return table;
}

Tiling square_in_square(double p) {
  // At |p| = 1 the square fills the cell, and the walls of neighbouring squares coincide. Beyond, nothing changes.
  const double a = std::min(std::abs(p), 1.0);
  Tiling tiling;
  tiling.lattice = 2 * Eigen::Matrix2d::Identity();
  const auto add = [&](const Polygon& tile, std::initializer_list<Placement> placements) {
    for (Placement placement : placements) {
      placement.tile = static_cast<int>(tiling.tiles.size());
      tiling.placements.push_back(placement);
    }
    tiling.tiles.push_back(tile);
  };
  if (2 * a > min_tile_side) add({{-a, -a}, {a, -a}, {a, a}, {-a, a}}, {{}});
  if (1 - a > min_tile_side) {
    // The first hexagon is the trapezoid above the inner square with its mirror image across the cell's upper side. The
    // second one is the first, rotated by -90 degrees.
    const Eigen::Matrix2d quarter_turn = (Eigen::Matrix2d() << 0, 1, -1, 0).finished();
    add(without_repetitions({{-1, 1}, {-a, a}, {a, a}, {1, 1}, {a, 2 - a}, {-a, 2 - a}}),
        {{}, {.linear = quarter_turn, .offset = {0, 0}}});
  }
  return tiling;
}

}  // namespace supple::tiling
