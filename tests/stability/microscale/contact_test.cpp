// Beams that touch across the patch's border, that touch after folding, and that nearly touch before any load.
#include <limits>

#include "simulation_case.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

// Hard: dozens of pairs come within the range of the barrier with which the path is followed, and some touch. In many
// of them, the segment is an image from a neighbouring cell.
TEST(ContactCases, ContactAcrossThePeriodicBoundaryHolds) {
  const UniaxialLoad load{2.094, {0.95, 0.9, 0.839}};
  const SimulationResult result = follow("IH01", std::vector{0.1191, 0.3178, 0.1199, 0.6276}, load);
  expect_resistance(result, load);
  EXPECT_GE(result.states.back().contacts, 6);
  EXPECT_LT(result.states.back().smallest_gap, 5e-4 * 0.3) << "what is left of the barrier is contact";
}

// Hard: the tile crosses itself, so that some sides are close to each other at rest, and the whole cell is meshed at
// once.
TEST(ContactCases, AFoldedTileUnderBiaxialLoadConverges) {
  follow("IH01", std::vector{0.2399, 0.5547, 0.0665, 0.4047}, BiaxialLoad{2.304, {{1.001, 0.939}}});
}

// Hard: a wall that is connected with nothing closes the gap to its own image. Until it touches, there is no stress,
// and thus no scale of forces.
TEST(ContactCases, AFreeWallThatClosesAGapConverges) {
  const BiaxialLoad load{0, {{0.99, 1}, {0.97, 1}, {0.94, 1}}};
  SimulationOptions options = hard_case_options();
  Simulator simulator(testing::wall(0.05, 4), options);
  const SimulationResult result = simulator.run(load);
  ASSERT_EQ(result.states.size(), 3U) << result.message;
  for (const State& state : result.states) expect_sound(state);
  EXPECT_LT(result.states[0].energy_density, 1e-12);
  EXPECT_GT(result.states[2].contacts, 0);
  EXPECT_LT(result.states[2].stress[0], -0.1) << "the closed wall must press";
}

/// 2 area / perimeter of a hole, mm. For a slit this is the gap between its sides.
double mean_width(const tiling::Polygon& hole) {
  double twice_area = 0;
  double perimeter = 0;
  for (std::size_t k = 0; k < hole.size(); ++k) {
    const Eigen::Vector2d& next = hole[(k + 1) % hole.size()];
    twice_area += hole[k].x() * next.y() - hole[k].y() * next.x();
    perimeter += (next - hole[k]).norm();
  }
  return twice_area / perimeter;
}

// Hard: the sides of long slits are 4 % of the beam width apart at rest. They come within the barrier's range under the
// smallest load, and touch later.
TEST(ContactCases, BeamsThatNearlyTouchAtRestConverge) {
  const std::vector<double> parameters{0.956};
  const tiling::Structure structure = tiling::make_structure(tiling::family("square"), parameters);
  double gap = std::numeric_limits<double>::infinity();
  for (const auto& holes : structure.holes) {
    for (const tiling::Polygon& hole : holes) gap = std::min(gap, mean_width(hole));
  }
  ASSERT_LT(gap, 0.05 * structure.beam_width);
  const UniaxialLoad load{0.3, {0.995, 0.97, 0.85}};
  const SimulationResult result = follow("square", parameters, load, hard_case_options(0.8));
  expect_resistance(result, load);
  EXPECT_GT(result.states.back().contacts, 0);
}

}  // namespace
}  // namespace supple::microscale
