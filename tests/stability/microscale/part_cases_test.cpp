// Parts under supports: cut beams, seams, plates that arrive late, mechanisms, snaps, walls of one element.
#include <cmath>
#include <numbers>
#include <utility>

#include "simulation_case.h"
#include "supple/microscale/part_simulation.h"
#include "supple/tiling/part.h"
#include "supple/tiling/part_mesh.h"
#include "support/drawn_meshes.h"
#include "support/preset_structure.h"

namespace supple::microscale {
namespace {

constexpr double part_beam_width = 0.3;  // mm

/// A part that is filled with the default structure of a family.
tiling::PartDesign filled(const tiling::PartShape& shape, const char* family) {
  tiling::PartDesign design;
  design.outline = shape.outline;
  design.solids = shape.solids;
  design.filling = {supple::testing::preset_structure(family), part_beam_width, 0};
  return design;
}

/// The solid within a polygon, without a structure.
tiling::PartDesign solid_polygon(const tiling::Polygon& polygon) {
  tiling::PartDesign design = filled({{polygon}, {}}, "IH01");
  design.frame = 100;
  return design;
}

tiling::PeriodicMesh mesh_of_part(const tiling::PartDesign& design, double mesh_size = 1) {
  tiling::MeshOptions options;
  options.mesh_size = mesh_size;
  options.corner_size = 0.5;
  return tiling::mesh_part(tiling::make_part(design).faces, part_beam_width, options);
}

Plate moving_plate(Side side, Eigen::Vector2d displacement, double gap = 0) {
  Plate plate;
  plate.side = side;
  plate.displacement = std::move(displacement);
  plate.gap = gap;
  return plate;
}

/// Follows the part through its path, and checks what must hold for every equilibrium: it converged, its forces
/// balance, and its energy is not negative.
PartSimulationResult follow_part(const tiling::PeriodicMesh& mesh, const std::vector<Support>& supports, int states) {
  PartSimulationOptions options;
  options.states = states;
  options.tolerance = 1e-7;
  const PartSimulationResult result = simulate_part(mesh, supports, options);
  EXPECT_EQ(result.message, "");
  EXPECT_EQ(result.states.size(), static_cast<std::size_t>(states));
  for (const PartState& state : result.states) {
    SCOPED_TRACE(::testing::Message() << "fraction " << state.fraction);
    EXPECT_EQ(state.stopped, PartStop::converged) << to_string(state.stopped);
    EXPECT_LE(state.residual, 1e-6);
    EXPECT_GE(state.energy, -1e-12);
    EXPECT_TRUE(std::isfinite(state.largest_strain));
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double largest = 0;
    for (const SupportState& support : state.supports) {
      sum += support.force;
      largest = std::max(largest, support.force.norm());
    }
    EXPECT_LE(sum.norm(), 1e-4 * largest + 1e-9) << "the forces do not balance";
  }
  return result;
}

// Hard: rows of beams buckle one after the other, and each time the stiffness becomes indefinite.
TEST(PartCases, ABlockBucklesRowByRow) {
  const auto mesh = mesh_of_part(filled(tiling::compression_block(15, 15, 1), "IH22"));
  const PartSimulationResult result =
      follow_part(mesh, {moving_plate(Side::bottom, {0, 0}), moving_plate(Side::top, {0, -1.5})}, 10);
  EXPECT_TRUE(result.states.back().stable);
  EXPECT_LT(result.states.back().supports[1].force.y(), 0);
}

// Hard: plates touch beams that end at the rim as single corners, which bend away.
TEST(PartCases, BeamsThatAreCutAtTheRimArePressed) {
  const auto mesh = mesh_of_part(filled(tiling::tensile_coupon(12, 12, 0), "IH01"));
  const PartSimulationResult result =
      follow_part(mesh, {moving_plate(Side::bottom, {0, 0}), moving_plate(Side::top, {0, -0.4})}, 4);
  for (const PartState& state : result.states) EXPECT_LE(state.supports[1].force.y(), 0);
}

// Hard: the plate arrives at one corner, and the line of contact grows along the tilted side.
TEST(PartCases, APlateArrivesLateAtATiltedSide) {
  const auto mesh = mesh_of_part(solid_polygon({{0, 0}, {6, 0}, {6, 5}, {0, 4.7}}));
  Clamp foot;
  foot.lower = {-1, -1};
  foot.upper = {7, 0.1};
  const PartSimulationResult result = follow_part(mesh, {foot, moving_plate(Side::top, {0, -0.6}, 0.1)}, 6);
  EXPECT_EQ(result.states.front().supports[1].touching, 0);
  EXPECT_GT(result.states[5].supports[1].touching, result.states[2].supports[1].touching);
  EXPECT_LT(result.states[5].supports[1].force.y(), result.states[2].supports[1].force.y());
}

// Hard: beams of two regions meet a seam at different distances, so that it bends between them.
TEST(PartCases, TwoRegionsOfUnequalPitchMeetAtASeam) {
  tiling::PartDesign design = filled(tiling::tensile_coupon(16, 10, 1), "IH22");
  design.regions.push_back(
      {{{0, 0}, {8, 0}, {8, 12}, {0, 12}}, {supple::testing::preset_structure("IH01"), 0.4, 0}, "left"});
  design.seam = 0.4;
  const auto mesh = mesh_of_part(design);
  Clamp lower, upper;
  lower.lower = {-1, -1};
  lower.upper = {17, 1};
  upper.lower = {-1, 11};
  upper.upper = {17, 13};
  upper.displacement = {0, 0.5};
  const PartSimulationResult result = follow_part(mesh, {lower, upper}, 4);
  EXPECT_GT(result.states.back().supports[1].force.y(), 0);
}

// Hard: a piece that hangs by a single node turns about it without any force.
TEST(PartCases, ACrumbThatOneNodeHoldsEndsWithAnAnswer) {
  auto mesh = testing::draw({"....",  //
                             "..#.",  //
                             "##..",  //
                             "##.."},
                            {0.5, 0.5, 0.5, 6}, {0.5, 0.5, 0.5, 6});
  mesh.mesh_size = 0.5;
  PartSimulationOptions options;
  options.states = 2;
  Clamp foot;
  foot.lower = {-1, -1};
  foot.upper = {2, 0};
  const PartSimulationResult result = simulate_part(mesh, {foot, moving_plate(Side::right, {-0.02, 0})}, options);
  ASSERT_FALSE(result.states.empty());
  EXPECT_TRUE(result.states.back().stopped == PartStop::converged || !result.message.empty());
}

// Hard: a flat arch that is pushed through loses its stiffness and snaps, while its crown is held.
TEST(PartCases, AnArchSnapsUnderAPrescribedDisplacement) {
  constexpr double span = 20, rise = 2, width = 0.5;
  constexpr int sides = 40;
  tiling::Polygon arch;
  const auto add = [&arch](double x, double offset) {
    arch.emplace_back(x, rise * std::sin(std::numbers::pi * x / span) + offset);
  };
  for (int k = 0; k <= sides; ++k) add(span * k / sides, 0);
  for (int k = sides; k >= 0; --k) add(span * k / sides, width);
  const auto mesh = mesh_of_part(solid_polygon(arch));
  Clamp left, right, crown;
  left.lower = {-1, -1};
  left.upper = {0.2, 3};
  right.lower = {span - 0.2, -1};
  right.upper = {span + 1, 3};
  crown.lower = {span / 2 - 0.3, 1};
  crown.upper = {span / 2 + 0.3, 4};
  crown.displacement = {0, -2 * rise};
  const PartSimulationResult result = follow_part(mesh, {left, right, crown}, 20);
  double largest_push = 0;
  for (const PartState& state : result.states) largest_push = std::max(largest_push, -state.supports[2].force.y());
  EXPECT_GT(largest_push, -result.states[10].supports[2].force.y())
      << "the force falls while the arch goes through the middle";
}

// Hard: walls are one element wide, so that each is bent by the sides of its own triangles.
TEST(PartCases, ThinWallsOfOneElementArePressed) {
  const auto mesh = mesh_of_part(filled(tiling::compression_block(12, 12, 1), "IH01"), 2);
  const PartSimulationResult result =
      follow_part(mesh, {moving_plate(Side::bottom, {0, 0}), moving_plate(Side::top, {0, -0.8})}, 4);
  EXPECT_LT(result.states.back().supports[1].force.y(), result.states.front().supports[1].force.y());
}

}  // namespace
}  // namespace supple::microscale
