#include "family_expressions.h"

#include <numbers>

namespace supple::tiling::testing {
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

void add_hexagons(std::vector<ExpressedFamily>& table) {
  table.push_back(
      {.id = "IH01",
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

void add_pentagons(std::vector<ExpressedFamily>& table) {
  // The bounds start above the type's own default of p1, 0.1045; the preset is the nearest value within them.
  table.push_back({.id = "IH21",
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

void add_quadrilaterals(std::vector<ExpressedFamily>& table) {
  table.push_back({.id = "IH50",
                   .parameters = {{0.1, 0.3, 0.2307692308}, {0.25, 0.75, 0.5}},
                   .beam_width = 0.0385,
                   .tile = {{0, 0}, {3.9 * p1 + 0.1, 5 * p2 - 2.5}, {3.9 * p1 + 0.1, 5 * p2 - 1.5}, {0, 1}},
                   .translations = {{{-15.6 * p1 - 0.4, 0}, {0, -1}}},
                   .placements = {{identity, {0, 0}},
                                  {rotation180, {0, 1}},
                                  {mirror_x, {7.8 * p1 + 0.2, 0}},
                                  {mirror_y, {-7.8 * p1 - 0.2, 1}}}});

  table.push_back({.id = "IH67",
                   .parameters = {{0.1, 0.3, 0.2307692308}, {0.6, 1.1, 0.8695652174}},
                   .beam_width = 0.0769,
                   .tile = {{1, 0}, {-3.45 * p2 + 4, 3.9 * p1 + 0.1}, {3.45 * p2 - 3, 3.9 * p1 + 0.1}, {0, 0}},
                   .translations = {{{-3.45 * p2 + 4, -3.9 * p1 - 0.1}, {-3.45 * p2 + 4, 3.9 * p1 + 0.1}}},
                   .placements = {{identity, {0, 0}}, {rotation180, {-3.45 * p2 + 5, 3.9 * p1 + 0.1}}}});
}

std::vector<ExpressedFamily> make_table() {
  std::vector<ExpressedFamily> table;
  add_hexagons(table);
  add_pentagons(table);
  add_quadrilaterals(table);
  return table;
}

Eigen::Vector2d at(const AffinePoint& point, std::span<const double> parameters) {
  return {point.x(parameters), point.y(parameters)};
}

}  // namespace

const std::vector<ExpressedFamily>& expressed_families() {
  static const std::vector<ExpressedFamily> table = make_table();
  return table;
}

Tiling evaluate(const ExpressedFamily& family, std::span<const double> parameters) {
  Tiling tiling;
  tiling.tiles.emplace_back();
  for (const AffinePoint& vertex : family.tile) tiling.tiles[0].push_back(at(vertex, parameters));
  for (const AffinePlacement& placement : family.placements) {
    const auto& [a, b, c, d] = placement.linear;
    tiling.placements.push_back(
        {.tile = 0, .linear = Eigen::Matrix2d{{a, b}, {c, d}}, .offset = at(placement.offset, parameters)});
  }
  for (int k = 0; k < 2; ++k) tiling.lattice.col(k) = at(family.translations[static_cast<std::size_t>(k)], parameters);
  return tiling;
}

}  // namespace supple::tiling::testing
