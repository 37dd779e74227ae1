// Random cells with sliding strands are compared with what must hold for each: scaling laws, the branch of lower
// energy, and limits of sliding.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "supple/base/random.h"
#include "supple/weave/homogenization.h"
#include "supple/weave/patterns.h"
#include "supple/weave/simulation.h"

namespace supple::weave {
namespace {

struct RandomCell {
  Weave weave;
  double strain = 0;
  std::string name;
};

RandomCell random_cell(std::uint64_t seed) {
  RandomStream random("random_cells", seed);
  RandomCell cell;
  const double side = random.uniform(8, 40);
  const int kind = random.below(4);
  cell.weave = kind == 3
                   ? interlacing_circles(CircleType::all_slide, side / 4, side / 4 * random.uniform(1.5, 1.95))
                   : interlacing_squares(static_cast<SquareType>(kind + 2), side, side * random.uniform(0.12, 0.4));
  limit_sliding(cell.weave, random.uniform(0.3, 0.95));
  cell.strain = random.below(5) == 0 ? random.uniform(-0.2, -0.02) : random.uniform(0.05, 0.4);
  cell.name = "seed " + std::to_string(seed) + ", kind " + std::to_string(kind) + ", side " + std::to_string(side) +
              ", strain " + std::to_string(cell.strain);
  return cell;
}

/// The same weave with all lengths multiplied by a factor.
Weave times(const Weave& weave, double factor) {
  Weave scaled = weave;
  for (Strand& strand : scaled.strands) strand = {strand.curve.scaled(factor), strand.radius * factor};
  for (Crossing& crossing : scaled.crossings) {
    for (CrossingMember& member : crossing.members) {
      member.coordinate *= factor;
      member.backward *= factor;
      member.forward *= factor;
    }
  }
  if (scaled.lattice) *scaled.lattice *= factor;
  return scaled;
}

HomogenizationOptions along_directions(double strain, int count) {
  HomogenizationOptions options;
  options.strain = strain;
  options.directions = directions_over_half_turn(count);
  return options;
}

double largest_energy(const std::vector<DirectionalResponse>& responses) {
  double largest = 0;
  for (const DirectionalResponse& response : responses)
    if (response.state.stopped == Stop::converged) largest = std::max(largest, response.state.energy_density);
  return largest;
}

TEST(RandomCells, AreProportionalToYoungsModulusAndToTheRightPowerOfLengths) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const RandomCell cell = random_cell(seed);
    SCOPED_TRACE(cell.name);
    RandomStream random("random_scales", seed);
    const double modulus = std::pow(10, random.uniform(-4, 4));
    const double length = std::pow(10, random.uniform(-2, 2));
    const HomogenizationOptions options = along_directions(cell.strain, 4);
    Weave stiff = cell.weave;
    stiff.material.youngs_modulus *= modulus;
    const auto usual = homogenize(cell.weave, options);
    const auto stiffer = homogenize(stiff, options);
    const auto larger = homogenize(times(cell.weave, length), options);
    for (std::size_t i = 0; i < usual.size(); ++i) {
      const CellState& state = usual[i].state;
      EXPECT_EQ(state.stopped, stiffer[i].state.stopped);
      EXPECT_EQ(state.stopped, larger[i].state.stopped);
      if (state.stopped != Stop::converged) continue;
      const double energy = state.energy_density;
      EXPECT_NEAR(stiffer[i].state.energy_density / modulus, energy, 1e-12 * energy) << i;
      EXPECT_NEAR(stiffer[i].youngs_modulus / modulus, usual[i].youngs_modulus,
                  1e-12 * std::abs(usual[i].youngs_modulus))
          << i;
      EXPECT_NEAR(larger[i].state.energy_density / length, energy, 1e-6 * energy + 1e-9 * largest_energy(usual)) << i;
      for (std::size_t k = 0; k < state.sliding.size(); ++k)
        EXPECT_EQ(state.sliding[k], stiffer[i].state.sliding[k]) << i << ' ' << k;
    }
  }
}

TEST(RandomCells, EndOnTheLowerSideWhateverTheWay) {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const RandomCell cell = random_cell(seed);
    SCOPED_TRACE(cell.name);
    const HomogenizationOptions options = along_directions(cell.strain, 24);
    const auto answer = homogenize(cell.weave, options);
    HomogenizationOptions straight = options;
    straight.equilibrium.buckling = Switch::off;
    HomogenizationOptions finer = options;
    finer.equilibrium.load_steps = 16;
    HomogenizationOptions turned = options;
    for (double& direction : turned.directions) direction += 1e-4;
    const double largest = largest_energy(answer);
    for (const HomogenizationOptions* other : {&straight, &finer, &turned}) {
      const auto compared_with = homogenize(cell.weave, *other);
      for (std::size_t i = 0; i < answer.size(); ++i) {
        const CellState& state = compared_with[i].state;
        if (state.stopped != Stop::converged || !state.stable || state.limit_error > 1e-6) continue;
        ++compared;
        EXPECT_LE(answer[i].state.energy_density, 1.005 * state.energy_density + 1e-6 * largest) << "direction " << i;
      }
    }
  }
  EXPECT_GT(compared, 200);
}

TEST(RandomCells, HaveEnergiesThatJumpNowhereBetweenNeighbouringDirections) {
  // Energies of the lowest equilibria are continuous in the direction. Between neighbours 0.002 rad apart they change
  // by no more than a few per cent.
  for (std::uint64_t seed = 11; seed <= 16; ++seed) {
    const RandomCell cell = random_cell(seed);
    SCOPED_TRACE(cell.name);
    HomogenizationOptions options = along_directions(cell.strain, 16);
    std::vector<double> directions;
    for (const double direction : options.directions)
      for (const double beside : {0.0, 0.002}) directions.push_back(direction + beside);
    options.directions = directions;
    const auto answer = homogenize(cell.weave, options);
    const double largest = largest_energy(answer);
    for (std::size_t i = 0; i + 1 < answer.size(); i += 2) {
      if (answer[i].state.stopped != Stop::converged || answer[i + 1].state.stopped != Stop::converged) continue;
      const double one = answer[i].state.energy_density;
      const double other = answer[i + 1].state.energy_density;
      EXPECT_NEAR(one, other, 0.05 * std::max(one, other) + 0.002 * largest) << "directions " << i << ", " << i + 1;
    }
  }
}

TEST(RandomCells, HaveSlidersWithinTheirLimitsAndSayHowFarFromThemTheyStand) {
  int stopped = 0;
  for (std::uint64_t seed = 21; seed <= 32; ++seed) {
    const RandomCell cell = random_cell(seed);
    SCOPED_TRACE(cell.name);
    const auto answer = homogenize(cell.weave, along_directions(cell.strain, 6));
    std::vector<const CrossingMember*> sliders;
    for (const Crossing& crossing : cell.weave.crossings)
      for (const CrossingMember& member : crossing.members)
        if (member.slides) sliders.push_back(&member);
    for (const DirectionalResponse& response : answer) {
      if (response.state.stopped != Stop::converged) continue;
      EXPECT_LE(response.state.limit_error, 1e-6) << response.direction;
      for (std::size_t k = 0; k < sliders.size(); ++k) {
        const double u = response.state.sliding[k];
        EXPECT_LE(u, sliders[k]->forward * (1 + 1e-4)) << response.direction << ' ' << k;
        EXPECT_GE(u, -sliders[k]->backward * (1 + 1e-4)) << response.direction << ' ' << k;
        if (std::min(sliders[k]->forward - u, u + sliders[k]->backward) < 1e-6) ++stopped;
      }
    }
  }
  EXPECT_GT(stopped, 50) << "hardly a slider was stopped, and the test shows nothing";
}

TEST(RandomCells, OfSheetsScaleLikeCells) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    RandomStream random("random_sheets", seed);
    const Weave sheet = interlacing_squares_sheet(SquareType::slide_both_ways, 2, 2);
    const double extent = 20.4;
    SheetLoad load;
    load.states = 2;
    for (const double x : {-6.0, 0.0, 6.0}) load.supports.push_back({0, x + 6});
    const auto last = static_cast<int>(sheet.strands.size()) - 1;
    load.supports.push_back({last, 6, {true, true, true}, {0.2 * extent * random.uniform(0.5, 1), extent * 0.1, 0}});
    const double modulus = std::pow(10, random.uniform(-3, 3));
    const double length = std::pow(10, random.uniform(-1, 1));
    Weave stiff = sheet;
    stiff.material.youngs_modulus *= modulus;
    SheetLoad longer = load;
    for (Support& support : longer.supports) {
      support.coordinate *= length;
      support.displacement *= length;
    }
    const SimulationResult usual = simulate(sheet, load);
    const SimulationResult stiffer = simulate(stiff, load);
    const SimulationResult larger = simulate(times(sheet, length), longer);
    ASSERT_EQ(usual.states.size(), stiffer.states.size());
    ASSERT_EQ(usual.states.size(), larger.states.size());
    const SheetState& state = usual.states.back();
    EXPECT_LE(state.limit_error, 1e-6);
    EXPECT_NEAR(stiffer.states.back().energy / modulus, state.energy, 1e-12 * state.energy) << "seed " << seed;
    EXPECT_NEAR(larger.states.back().energy / std::pow(length, 3), state.energy, 1e-5 * state.energy)
        << "seed " << seed;
    const double reaction = state.reactions.back().norm();
    EXPECT_NEAR(stiffer.states.back().reactions.back().norm() / modulus, reaction, 1e-12 * reaction);
    EXPECT_NEAR(larger.states.back().reactions.back().norm() / (length * length), reaction, 1e-5 * reaction);
  }
}

}  // namespace
}  // namespace supple::weave
