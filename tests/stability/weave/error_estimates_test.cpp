// The errors that homogenizations estimate are compared with the errors against rods of four times the resolution, at
// random weaves of every pattern.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/weave/homogenization.h"
#include "supple/weave/patterns.h"

namespace supple::weave {
namespace {

struct RandomWeave {
  Weave weave;
  HomogenizationOptions options;
  std::string name;
};

/// A weave of a random pattern under a random strain along three random directions.
RandomWeave random_weave(std::uint64_t seed) {
  RandomStream random("error_estimates", seed);
  RandomWeave made;
  const int kind = random.below(7);
  const double side = random.uniform(8, 40);
  if (kind == 0) {
    ConnectionBlock block = uniform_block(Connection::fused);
    block[0][1] = random.below(2) == 0 ? Connection::slides_x : Connection::fused;
    block[1][0] = random.below(2) == 0 ? Connection::slides_y : Connection::fused;
    made.weave = regular_weave(block);
  } else if (kind < 5) {
    made.weave = interlacing_squares(static_cast<SquareType>(kind), side, side * random.uniform(0.12, 0.4));
  } else {
    made.weave = interlacing_circles(kind == 5 ? CircleType::all_fused : CircleType::all_slide, side / 4,
                                     side / 4 * random.uniform(1.5, 1.95));
  }
  made.options.strain = random.below(4) == 0 ? random.uniform(-0.15, -0.02) : random.uniform(0.02, 0.25);
  for (int k = 0; k < 3; ++k) made.options.directions.push_back(random.uniform(0, std::numbers::pi));
  made.name = "seed " + std::to_string(seed) + ", kind " + std::to_string(kind) + ", side " + std::to_string(side) +
              ", strain " + std::to_string(made.options.strain);
  return made;
}

/// What the errors of one number turned out to be.
struct Comparison {
  int compared = 0;
  int within = 0;
  std::vector<double> ratios;  ///< estimate over error

  void add(double estimate, double error) {
    ++compared;
    if (error <= estimate) ++within;
    if (error > 0) ratios.push_back(estimate / error);
  }
  double median_ratio() {
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    return *middle;
  }
};

TEST(EstimatedErrors, AreAboveTheErrorsInNineOfTenDirectionsAndAtMostTenTimesTooLarge) {
  Comparison modulus;
  Comparison poisson;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    RandomWeave made = random_weave(seed);
    SCOPED_TRACE(made.name);
    made.options.equilibrium.error_estimate = Switch::automatic;
    const auto estimated = homogenize(made.weave, made.options);
    // The reference is extrapolated from two finer resolutions, whose errors fall with the square of their segments.
    HomogenizationOptions finer = made.options;
    finer.equilibrium.error_estimate = Switch::off;
    finer.equilibrium.segments = 8;
    finer.equilibrium.max_segment_turn = 0.3;
    const auto fine = homogenize(made.weave, finer);
    finer.equilibrium.segments = 16;
    finer.equilibrium.max_segment_turn = 0.15;
    const auto finest = homogenize(made.weave, finer);
    for (std::size_t i = 0; i < estimated.size(); ++i) {
      const DirectionalResponse& one = estimated[i];
      const double reference = finest[i].youngs_modulus + (finest[i].youngs_modulus - fine[i].youngs_modulus) / 3;
      // Without a reference, or where the three are on different branches, there is nothing to compare with.
      if (!std::isfinite(one.youngs_modulus) || !std::isfinite(reference)) continue;
      if (std::abs(finest[i].youngs_modulus - fine[i].youngs_modulus) > 0.2 * std::abs(reference)) continue;
      ASSERT_TRUE(std::isfinite(one.youngs_modulus_error)) << i;
      modulus.add(one.youngs_modulus_error, std::abs(one.youngs_modulus - reference));
      poisson.add(one.poisson_ratio_error, std::abs(one.poisson_ratio - finest[i].poisson_ratio -
                                                    (finest[i].poisson_ratio - fine[i].poisson_ratio) / 3));
    }
  }
  EXPECT_GE(modulus.compared, 60);
  EXPECT_GE(modulus.within, 0.9 * modulus.compared);
  EXPECT_GE(poisson.within, 0.9 * poisson.compared);
  EXPECT_LE(modulus.median_ratio(), 10);
  EXPECT_LE(poisson.median_ratio(), 10);
}

TEST(EstimatedErrors, BetweenComparedDirectionsAreAboveTheErrorsToo) {
  const Weave weave = interlacing_circles(CircleType::all_fused);
  HomogenizationOptions options;
  options.directions = directions_over_half_turn(72);
  options.equilibrium.error_estimate = Switch::automatic;
  const auto estimated = homogenize(weave, options);
  options.equilibrium.error_estimate = Switch::off;
  options.equilibrium.segments = 16;
  options.equilibrium.max_segment_turn = 0.15;
  const auto reference = homogenize(weave, options);
  int within = 0;
  for (std::size_t i = 0; i < estimated.size(); ++i)
    within += std::abs(estimated[i].youngs_modulus - reference[i].youngs_modulus) <= estimated[i].youngs_modulus_error;
  EXPECT_GE(within, 65);
}

}  // namespace
}  // namespace supple::weave
