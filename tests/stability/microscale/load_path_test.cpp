// Paths that are hard to follow: with steps that are too long, with buckling, and back to rest.
#include "simulation_case.h"

namespace supple::microscale {
namespace {

// Hard: load steps are ten times as long as usual, so that beams buckle and touch within one step.
TEST(LoadPath, ALoadStepTenTimesTooLargeConverges) {
  SimulationOptions options = hard_case_options();
  options.max_load_step = 0.5;
  const UniaxialLoad load{0.5, {0.95, 0.9, 0.8, 0.7}};
  expect_resistance(follow("IH01", preset("IH01"), load, options), load);
}

// Hard: the only state that is requested is at the end of the range of loads.
TEST(LoadPath, OneJumpToTheEndConverges) {
  SimulationOptions options = hard_case_options();
  options.max_load_step = 0.5;
  for (const UniaxialLoad& load : {UniaxialLoad{0.5, {0.7}}, UniaxialLoad{0.5, {1.5}}})
    expect_resistance(follow("IH22", preset("IH22"), load, options), load);
}

// Hard: the cell's own equilibrium remains stable against all modes of one cell. Only alternating modes are unstable.
TEST(LoadPath, BucklingOverTwoCellsIsFoundByOneCellAndByThePatch) {
  const UniaxialLoad load{2.094, {0.95, 0.9, 0.839}};
  const std::vector parameters{0.1191, 0.3178, 0.1199, 0.6276};
  SimulationOptions options = hard_case_options(0.8);
  const SimulationResult found = follow("IH01", parameters, load, options);
  options.patch = Switch::on;
  const SimulationResult patch = follow("IH01", parameters, load, options);
  ASSERT_EQ(found.states.size(), patch.states.size());
  EXPECT_EQ(found.states.back().cells, 2) << "the case does not buckle over two cells";
  for (std::size_t k = 0; k < found.states.size(); ++k) {
    const double expected = patch.states[k].energy_density;
    EXPECT_NEAR(found.states[k].energy_density, expected, 1e-4 * expected) << "stretch " << load.stretches[k];
  }
}

// Hard: on its way back, the path passes the load at which the beams have buckled.
TEST(LoadPath, APathBackToRestEndsWithoutEnergy) {
  const SimulationResult result = follow("IH01", preset("IH01"), UniaxialLoad{0.5, {0.95, 0.88, 0.8, 0.88, 0.95, 1}});
  ASSERT_EQ(result.states.size(), 6U);
  const double most = result.states[2].energy_density;
  EXPECT_LT(result.states.back().energy_density, 1e-8 * most);
  for (const int k : {0, 1}) {
    const double there = result.states[k].energy_density;
    EXPECT_NEAR(result.states[4 - k].energy_density, there, 1e-4 * there) << "state " << k;
  }
}

// Hard: results must be equal to the last bit, although beams buckle and touch on the path.
TEST(LoadPath, TheSameRequestTwiceIsBitIdentical) {
  const UniaxialLoad load{2.094, {0.9, 0.839}};
  const std::vector parameters{0.1191, 0.3178, 0.1199, 0.6276};
  const SimulationResult first = follow("IH01", parameters, load);
  const SimulationResult second = follow("IH01", parameters, load);
  ASSERT_EQ(first.states.size(), second.states.size());
  for (std::size_t k = 0; k < first.states.size(); ++k) {
    EXPECT_EQ(first.states[k].energy_density, second.states[k].energy_density);
    EXPECT_EQ(first.states[k].stress, second.states[k].stress);
    EXPECT_EQ(first.states[k].tangent, second.states[k].tangent);
    EXPECT_EQ(first.states[k].iterations, second.states[k].iterations);
    EXPECT_EQ(first.states[k].deformed->nodes, second.states[k].deformed->nodes);
  }
}

}  // namespace
}  // namespace supple::microscale
