#include "supple/weave/homogenization.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "layouts.h"
#include "supple/base/threads.h"
#include "supple/weave/patterns.h"
#include "supple/weave/weave_error.h"
#include "support/expect_error.h"

namespace supple::weave {
namespace {

using std::numbers::pi;

DirectionalResponse along(const Weave& weave, double degrees, double strain, bool shear_free = true) {
  HomogenizationOptions options;
  options.strain = strain;
  options.directions = {degrees * pi / 180};
  options.shear_free = shear_free;
  options.equilibrium.out_of_plane = Switch::off;
  DirectionalResponse response = homogenize(weave, options).front();
  EXPECT_EQ(response.state.stopped, Stop::converged) << degrees;
  EXPECT_LE(response.state.residual, response.state.tolerance) << degrees;
  return response;
}

TEST(RegularWeave, AlongItsStrandsHasTheirStiffnessOverTheirDistanceWhateverTheCrossings) {
  const double strain = 0.05;
  const double exact = 1000 * circular(0.25, {}).stretch / 4;  // N/m; there is no lateral contraction
  for (const Connection connection : {Connection::fused, Connection::slides_x, Connection::slides_y}) {
    const Weave weave = regular_weave(uniform_block(connection));
    for (const double degrees : {0.0, 90.0})
      EXPECT_NEAR(along(weave, degrees, strain).youngs_modulus, exact, 1e-6 * exact) << degrees;
  }
}

/// Requests a stop once some tasks of a stage are finished.
struct StopAfterTasks : ProgressSink {
  explicit StopAfterTasks(StopReason its_reason) : reason(its_reason) {}
  void report(double done, std::string_view stage) override {
    if ((stage == "directions" || stage == "gradients") && done >= 0.2) token.request(reason);
  }
  CancellationToken token;
  StopReason reason;
};

TEST(Homogenization, KeepsTheDirectionsThatWereFinishedIfTimeOrMemoryRunsOut) {
  const Weave weave = regular_weave(uniform_block(Connection::fused));
  HomogenizationOptions options;
  options.directions = directions_over_half_turn(12);
  options.equilibrium.out_of_plane = Switch::off;
  const auto whole = homogenize(weave, options);
  for (const StopReason reason : {StopReason::deadline, StopReason::memory}) {
    StopAfterTasks stopper(reason);
    const auto responses = homogenize(weave, options, {.cancellation = stopper.token, .progress = &stopper});
    ASSERT_EQ(responses.size(), 12U);
    int finished = 0;
    for (std::size_t i = 0; i < responses.size(); ++i) {
      EXPECT_EQ(responses[i].direction, options.directions[i]);
      if (responses[i].state.stopped == Stop::converged) {
        ++finished;
        EXPECT_EQ(responses[i].youngs_modulus, whole[i].youngs_modulus);
      } else {
        EXPECT_EQ(responses[i].state.stopped, reason == StopReason::deadline ? Stop::deadline : Stop::memory);
        EXPECT_TRUE(std::isnan(responses[i].youngs_modulus) && std::isnan(responses[i].poisson_ratio));
      }
    }
    EXPECT_GE(finished, 3);
    EXPECT_LT(finished, 12);
    EXPECT_FALSE(stopper.token.requested()) << "the report goes on";
  }
  StopAfterTasks cancelled(StopReason::cancelled);
  ::supple::testing::expect_cancelled(StopReason::cancelled, [&] {
    homogenize(weave, options, {.cancellation = cancelled.token, .progress = &cancelled});
  });
}

TEST(DeformCells, KeepTheStatesThatWereFinished) {
  const Weave weave = regular_weave(uniform_block(Connection::fused));
  std::vector<Eigen::Matrix2d> gradients(10, Eigen::Matrix2d::Identity());
  for (std::size_t i = 0; i < gradients.size(); ++i) gradients[i](0, 0) += 0.01 * static_cast<double>(i + 1);
  StopAfterTasks stopper(StopReason::deadline);
  const auto states = deform_cells(weave, gradients, {}, {}, {.cancellation = stopper.token, .progress = &stopper});
  int finished = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (states[i].stopped == Stop::deadline) continue;
    ++finished;
    EXPECT_EQ(states[i].stopped, Stop::converged);
    EXPECT_LT((states[i].deformation_gradient - gradients[i]).norm(), 1e-12);
  }
  EXPECT_GE(finished, 2);
  EXPECT_LT(finished, 10);
}

TEST(RegularWeave, AtFortyFiveDegreesIsStiffWhereItIsFusedAndSoftWhereItSlides) {
  // The weave becomes stiffer with each fused crossing of the 2x2 cell.
  ConnectionBlock block = uniform_block(Connection::slides_x);
  double last = along(regular_weave(block), 45, 0.1).youngs_modulus;
  EXPECT_LT(std::abs(last), 1e-2);
  for (const auto& [row, column] : {std::pair(0, 0), std::pair(1, 1), std::pair(0, 1), std::pair(1, 0)}) {
    block[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = Connection::fused;
    const double now = along(regular_weave(block), 45, 0.1).youngs_modulus;
    EXPECT_GE(now, last - 1e-2) << row << column;
    last = now;
  }
  EXPECT_GT(last, 1000);
}

TEST(RegularWeave, FusedInShearBendsItsStrandsAsFixedBeams) {
  // Small strain at 45 degrees: a shear angle g bends each of the joint's four half strands of length a / 2, clamped at
  // the joint and free of moment at midspan, by (a / 2)(g / 2). The energy of a joint is 4 * 3 EI / 2 / (a / 2)^3 * (a
  // g / 4)^2 = 3 EI g^2 / a. With cells of area a^2 and g = 2 e at the strains e and -e along the diagonals, the shear
  // modulus is G = 6 EI / a^3.
  const double a = 4;
  const Stiffness s = circular(0.25, {});
  const double g = 6 * s.bend / (a * a * a);
  const double stretch = s.stretch / a;  // Young's modulus along the strands, where Poisson's ratio is 0
  const double exact = 1000 / (1 / (4 * g) + 1 / (2 * stretch));
  double last = 0;
  for (const int segments : {4, 8, 16}) {
    HomogenizationOptions options;
    options.strain = 1e-6;
    options.directions = {pi / 4};
    options.equilibrium.segments = segments;
    options.equilibrium.tolerance = 1e-9;
    const double error =
        std::abs(homogenize(regular_weave(uniform_block(Connection::fused)), options)[0].youngs_modulus / exact - 1);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2, 0.3) << segments << " error " << error;
    }
    last = error;
  }
  EXPECT_LT(last, 1e-2);
}

TEST(InterlacingSquares, OfTypeOneAreStiffAndNearlyIsotropic) {
  const Weave weave = interlacing_squares(SquareType::all_fused);
  double least = 1e300;
  double most = 0;
  for (const double degrees : {0.0, 30.0, 45.0, 60.0, 90.0, 135.0}) {
    const double e = along(weave, degrees, 0.1).youngs_modulus;
    least = std::min(least, e);
    most = std::max(most, e);
  }
  EXPECT_GT(least, 500);
  EXPECT_LT(most / least, 2.2);
}

/// Number of the squares' sliders that are at the ends of their range of 2.1 mm.
int sliders_at_limit(const DirectionalResponse& response) {
  int count = 0;
  for (const double u : response.state.sliding) count += std::abs(std::abs(u) - 2.1) < 1e-5 ? 1 : 0;
  return count;
}

TEST(InterlacingSquares, OfTypeTwoHaveNoStiffnessInXUntilTheirSlidersLock) {
  const Weave weave = interlacing_squares(SquareType::all_slide_x);
  // Two sliders in a row allow a displacement of 2 * 2.1 mm in a period of 18 mm, which is 23.3 %.
  EXPECT_LT(std::abs(along(weave, 0, 0.10).youngs_modulus), 1e-2);
  EXPECT_LT(std::abs(along(weave, 0, 0.22).youngs_modulus), 1e-2);
  EXPECT_LT(std::abs(along(weave, 0, 0.233).youngs_modulus), 1e-2);
  EXPECT_GT(along(weave, 0, 0.24).youngs_modulus, 10);
  const DirectionalResponse locked = along(weave, 0, 0.30);
  EXPECT_GT(locked.youngs_modulus, 100);
  // Sides of squares buckle, and some sliders then leave their limits. Rounding decides which ones do. Two in a row
  // carry the load at their limits.
  EXPECT_GE(sliders_at_limit(locked), 2);
  // If no unstable equilibrium is left, all sliders stay at their limits.
  HomogenizationOptions straight;
  straight.strain = 0.30;
  straight.directions = {0};
  straight.equilibrium.out_of_plane = Switch::off;
  straight.equilibrium.buckling = Switch::off;
  const DirectionalResponse unbuckled = homogenize(weave, straight).front();
  EXPECT_EQ(unbuckled.state.stopped, Stop::converged);
  EXPECT_GE(sliders_at_limit(unbuckled), 4);
  EXPECT_GT(along(weave, 90, 0.10).youngs_modulus, 300) << "in y nothing slides";
}

TEST(InterlacingSquares, OfTypeThreeAreOrthotropic) {
  const Weave weave = interlacing_squares(SquareType::slide_both_ways);
  const double x = along(weave, 0, 0.1).youngs_modulus;
  EXPECT_NEAR(along(weave, 90, 0.1).youngs_modulus / x, 1, 1e-3);
  EXPECT_NEAR(along(weave, 30, 0.1).youngs_modulus / along(weave, 150, 0.1).youngs_modulus, 1, 1e-3);
  EXPECT_LT(along(weave, 45, 0.1).youngs_modulus, 0.6 * x);
  EXPECT_LT(x, 0.4 * along(interlacing_squares(SquareType::all_fused), 0, 0.1).youngs_modulus);
}

TEST(InterlacingSquares, OfTypeFourDifferBetweenTheirDiagonals) {
  const Weave weave = interlacing_squares(SquareType::one_corner_fused);
  const double one = along(weave, 45, 0.1).youngs_modulus;
  const double other = along(weave, 135, 0.1).youngs_modulus;
  EXPECT_GT(std::abs(one / other - 1), 0.05);
  EXPECT_GT(one, 1.3 * along(interlacing_squares(SquareType::slide_both_ways), 45, 0.1).youngs_modulus);
}

TEST(InterlacingCircles, AreOrthotropicWhereFusedAndAsymmetricAboutTheDiagonalWhereTheySlide) {
  const Weave fused = interlacing_circles(CircleType::all_fused);
  EXPECT_NEAR(along(fused, 45, 0.1).youngs_modulus / along(fused, 135, 0.1).youngs_modulus, 1, 1e-3);
  EXPECT_NEAR(along(fused, 0, 0.1).youngs_modulus / along(fused, 90, 0.1).youngs_modulus, 1, 1e-3);
  const Weave sliding = interlacing_circles(CircleType::all_slide);
  EXPECT_GT(along(sliding, 45, 0.1).youngs_modulus / along(sliding, 135, 0.1).youngs_modulus, 1.1);
  EXPECT_LT(along(sliding, 0, 0.1).youngs_modulus, 0.5 * along(fused, 0, 0.1).youngs_modulus);
}

TEST(Homogenization, LeavesLateralStressAndShearFreeAndImposesTheStrainExactly) {
  const Weave weave = interlacing_squares(SquareType::one_corner_fused);
  const double direction = 0.7;
  const DirectionalResponse response = along(weave, direction * 180 / pi, 0.1);
  const Eigen::Vector2d d(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d n(-d[1], d[0]);
  EXPECT_LT((response.state.deformation_gradient.transpose() * d - 1.1 * d).norm(), 1e-14);
  const double sigma = d.dot(response.state.cauchy_stress * d);
  EXPECT_LT(std::abs(n.dot(response.state.cauchy_stress * n)), 1e-4 * sigma);
  EXPECT_LT(std::abs(n.dot(response.state.cauchy_stress * d)), 1e-4 * sigma);
  EXPECT_LT(std::abs(d.dot(response.state.cauchy_stress * n)), 1e-4 * sigma);
  // The published variant suppresses the shear, so that it can only be stiffer.
  const DirectionalResponse published = along(weave, direction * 180 / pi, 0.1, false);
  EXPECT_GT(published.youngs_modulus, response.youngs_modulus * 1.001);
  EXPECT_LT(std::abs(n.dot(published.state.deformation_gradient * d)), 1e-14);
}

TEST(Homogenization, StressIsTheDerivativeOfTheEnergy) {
  const Weave weave = interlacing_circles(CircleType::all_slide);
  Eigen::Matrix2d f;
  f << 1.08, 0.03, -0.02, 0.97;
  EquilibriumOptions options;
  options.tolerance = 1e-9;
  options.out_of_plane = Switch::off;
  const CellState at = deform_cell(weave, f, options);
  EXPECT_LT((at.deformation_gradient - f).norm(), 1e-15);
  const double h = 1e-5;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      Eigen::Matrix2d more = f;
      Eigen::Matrix2d less = f;
      more(i, j) += h;
      less(i, j) -= h;
      const double slope =
          (deform_cell(weave, more, options).energy_density - deform_cell(weave, less, options).energy_density) /
          (2 * h);
      EXPECT_NEAR(at.nominal_stress(i, j), slope, 1e-5 * at.nominal_stress.norm()) << i << j;
    }
  }
  // The Cauchy stress is symmetric because angular momentum is balanced.
  EXPECT_NEAR(at.cauchy_stress(0, 1), at.cauchy_stress(1, 0), 1e-7 * at.cauchy_stress.norm());
}

TEST(Homogenization, DeformsSeveralCellsAsEachByItself) {
  const Weave weave = interlacing_squares(SquareType::all_slide_x);
  std::vector<Eigen::Matrix2d> gradients(3, Eigen::Matrix2d::Identity());
  gradients[1] << 1.05, 0.02, 0, 0.98;
  gradients[2] << 1, 0.1, 0.1, 1;
  CostLedger cost;
  Execution execution;
  execution.cost = &cost;
  const auto states = deform_cells(weave, gradients, {}, {2}, execution);
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states[0].nominal_stress.norm(), 0);
  for (std::size_t i = 0; i < 3; ++i) {
    const CellState alone = deform_cell(weave, gradients[i], {}, {}, i == 2);
    EXPECT_LT((states[i].deformation_gradient - gradients[i]).norm(), 1e-15);
    EXPECT_EQ(states[i].nominal_stress, alone.nominal_stress);
    EXPECT_EQ(states[i].sliding, alone.sliding);
    EXPECT_EQ(states[i].strands, alone.strands);
    EXPECT_EQ(states[i].strands.empty(), i != 2);
  }
  EXPECT_FALSE(cost.effects().empty());
  const auto refused = [&](const std::vector<Eigen::Matrix2d>& given, const std::vector<int>& deformed) {
    return ::supple::testing::places(::supple::testing::expect_error<InvalidLoad>(
        "weave.invalid_load", [&] { deform_cells(weave, given, {}, deformed); }));
  };
  gradients[1] << 1, 0, 0, -1;
  gradients[2](0, 0) = NAN;
  EXPECT_EQ(refused(gradients, {3, -1}), (std::vector<std::string>{"deformation_gradients/1", "deformation_gradients/2",
                                                                   "deformed/0", "deformed/1"}));
  EXPECT_EQ(refused({}, {}), std::vector<std::string>{"deformation_gradients"});
}

TEST(Homogenization, CostsNothingUnderARotationOfTheCell) {
  Eigen::Matrix2d f;
  f << std::cos(0.4), -std::sin(0.4), std::sin(0.4), std::cos(0.4);
  for (const Weave& weave : {interlacing_circles(CircleType::all_fused), interlacing_squares(SquareType::all_fused)}) {
    const CellState state = deform_cell(weave, f);
    EXPECT_EQ(state.stopped, Stop::converged);
    EXPECT_LT(state.energy_density, 1e-9);
  }
}

TEST(Homogenization, DoesNotDependOnWhichCellOfTheSheetIsTaken) {
  // A doubled cell of the same weave has the same modulus if nothing buckles.
  const Weave one = interlacing_circles(CircleType::all_fused);
  Weave two;
  two.lattice = *one.lattice * Eigen::Vector2d(2, 1).asDiagonal();
  two.strands = {circle(5.5, {0, 0}, 64), circle(5.5, {10, 0}, 64)};
  two.crossings = find_crossings(two.strands, two.lattice);
  EXPECT_EQ(two.crossings.size(), 8U);
  const double expected = along(one, 20, 0.05).youngs_modulus;
  EXPECT_NEAR(along(two, 20, 0.05).youngs_modulus, expected, 1e-6 * expected);
}

TEST(Homogenization, GivesTheSameBitsOnOneThreadAndOnTwoAndMegapascalsForAThickness) {
  HomogenizationOptions options;
  options.directions = {0, pi / 8, pi / 4};
  options.thickness = 0.5;
  const Weave weave = interlacing_squares(SquareType::slide_both_ways);
  set_thread_count(1);
  const auto one = homogenize(weave, options);
  set_thread_count(2);
  const auto two = homogenize(weave, options);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].youngs_modulus, two[i].youngs_modulus);
    EXPECT_DOUBLE_EQ(one[i].youngs_modulus_mpa, one[i].youngs_modulus / 500);
  }
}

TEST(Homogenization, SaysWhichEffectsRanAndWhy) {
  const auto effects = [](const Weave& weave, double strain) {
    CostLedger ledger;
    Execution execution;
    execution.cost = &ledger;
    HomogenizationOptions options;
    options.strain = strain;
    options.directions = {0};
    homogenize(weave, options, execution);
    std::map<std::string, bool> ran;
    for (const auto& effect : ledger.effects()) {
      ran[effect.name] = effect.ran;
      EXPECT_FALSE(effect.why.empty()) << effect.name;
    }
    return ran;
  };
  auto fused = effects(interlacing_circles(CircleType::all_fused), 0.02);
  EXPECT_TRUE(fused.at("joint_bend"));
  EXPECT_FALSE(fused.at("sliding_regularizer"));
  EXPECT_FALSE(fused.at("twist"));
  EXPECT_FALSE(fused.at("out_of_plane"));
  auto sliding = effects(regular_weave(uniform_block(Connection::slides_x)), 0.02);
  EXPECT_FALSE(sliding.at("joint_bend"));
  EXPECT_TRUE(sliding.at("sliding_regularizer"));
  EXPECT_FALSE(sliding.at("at_sliding_limits"));
  EXPECT_TRUE(effects(interlacing_squares(SquareType::all_slide_x), 0.26).at("at_sliding_limits"));
}

TEST(Homogenization, RefusesOptionsOutOfRangeAndWeavesWithoutALattice) {
  const auto refused = [](const char* code, const Weave& weave, HomogenizationOptions options) {
    return ::supple::testing::expect_error(code, [&] { homogenize(weave, options); });
  };
  const Weave weave = regular_weave(uniform_block(Connection::fused));
  EXPECT_EQ(::supple::testing::places(refused("weave.invalid_option", weave, {.strain = 0, .directions = {0}})),
            std::vector<std::string>{"strain"});
  refused("weave.invalid_option", weave, {.directions = {}});
  refused("weave.invalid_option", weave, {.directions = {NAN}});
  refused("weave.invalid_option", weave, {.equilibrium = {.segments = 0}, .directions = {0}});
  refused("weave.not_periodic", wavy(), {.directions = {0}});
  ::supple::testing::expect_error<InvalidLoad>("weave.invalid_load",
                                               [&] { deform_cell(weave, Eigen::Vector2d(1, -1).asDiagonal()); });
}

TEST(Homogenize, FillsTheStrandsOfTheDirectionsThatAreAskedFor) {
  HomogenizationOptions options;
  options.directions = {0, 0.5, 1};
  options.deformed = {2, 0};
  const Weave weave = regular_weave(uniform_block(Connection::fused));
  const auto responses = homogenize(weave, options);
  EXPECT_TRUE(responses[1].state.strands.empty());
  for (const std::size_t i : {0U, 2U}) {
    ASSERT_EQ(responses[i].state.strands.size(), 4U);
    // A periodic strand ends one deformed translation from where it begins.
    const auto& strand = responses[i].state.strands.front();
    const Eigen::Vector2d period = responses[i].state.deformation_gradient * weave.lattice->col(0);
    EXPECT_NEAR(((strand.back() - strand.front()).head<2>() - period).norm(), 0, 1e-9);
  }
  options.deformed = {3, -1};
  const auto error =
      ::supple::testing::expect_error<InvalidOption>("weave.invalid_option", [&] { homogenize(weave, options); });
  EXPECT_EQ(::supple::testing::places(error), (std::vector<std::string>{"deformed/0", "deformed/1"}));
}

std::vector<DirectionalResponse> squares_at_30_percent(int load_steps, Switch buckling = Switch::automatic) {
  HomogenizationOptions options;
  options.strain = 0.3;
  options.directions = {0, pi / 8, pi / 4};
  options.equilibrium.load_steps = load_steps;
  options.equilibrium.buckling = buckling;
  return homogenize(interlacing_squares(SquareType::all_slide_x), options);
}

TEST(Homogenize, FollowsThePathInStepsShortEnoughToStayOnIt) {
  const auto automatic = squares_at_30_percent(0);
  const auto fine = squares_at_30_percent(32);
  // With buckling, a path that left an unstable equilibrium would be compared with a finer path.
  const auto single = squares_at_30_percent(1, Switch::off);
  int astray = 0;
  for (std::size_t i = 0; i < fine.size(); ++i) {
    EXPECT_GE(automatic[i].state.load_steps, 8) << "0.3 / 0.04";
    EXPECT_NEAR(automatic[i].state.energy_density / fine[i].state.energy_density, 1, 1e-3) << i;
    if (single[i].state.energy_density > 1.2 * fine[i].state.energy_density) ++astray;
  }
  EXPECT_GE(astray, 1) << "one step would do, and the test shows nothing";
}

/// Energies of sliding squares at a strain of 0.1 in two directions that a mirror symmetry of the cell exchanges.
std::array<double, 2> energies_of_mirror_images(int segments, int load_steps, int& branches) {
  HomogenizationOptions options;
  options.strain = 0.1;
  options.directions = {5 * pi / 24, 7 * pi / 24};
  options.equilibrium.segments = segments;
  options.equilibrium.load_steps = load_steps;
  std::array<double, 2> energies{};
  const auto responses = homogenize(interlacing_squares(SquareType::slide_both_ways), options);
  for (std::size_t i = 0; i < 2; ++i) {
    energies[i] = responses[i].state.energy_density;
    branches += responses[i].state.branches;
    EXPECT_TRUE(responses[i].state.stable);
  }
  return energies;
}

TEST(Homogenize, TakesTheLowerSideOfARidgeWhateverTheSegmentsAndTheLoadSteps) {
  // At a strain below 0.0025 the loops begin to slide in one of two directions, and lock in equilibria of different
  // energy. The lower energy is 0.754 J/m^2 with 4 segments.
  int branches = 0;
  for (const int load_steps : {0, 10, 25}) {
    const auto [one, other] = energies_of_mirror_images(4, load_steps, branches);
    EXPECT_NEAR(one, 0.7541, 1e-3) << load_steps;
    EXPECT_NEAR(one / other, 1, 1e-6) << load_steps;
  }
  const auto finer = energies_of_mirror_images(8, 0, branches);
  const auto finest = energies_of_mirror_images(16, 0, branches);
  EXPECT_NEAR(finer[0] / finer[1], 1, 1e-6);
  EXPECT_NEAR(finest[0] / finest[1], 1, 1e-6);
  EXPECT_NEAR((0.75413 - finer[0]) / (finer[0] - finest[0]), 4, 0.8) << "segments converge with their square";
  EXPECT_GE(branches, 1) << "the first side was the lower one everywhere, and the test shows nothing";
}

TEST(Homogenize, BillsThatItLookedAtTheOtherSideWhereThatIsNotLower) {
  const Weave weave = interlacing_squares(SquareType::slide_both_ways);
  int looked_in_vain = 0;
  for (const double direction : directions_over_half_turn(24)) {
    if (looked_in_vain > 0) break;
    CostLedger ledger;
    Execution execution;
    execution.cost = &ledger;
    HomogenizationOptions options;
    options.strain = 0.1;
    options.directions = {direction};
    const auto response = homogenize(weave, options, execution).front();
    for (const auto& effect : ledger.effects())
      if (effect.name == "buckling" && effect.ran && response.state.branches == 0) ++looked_in_vain;
  }
  EXPECT_GE(looked_in_vain, 1);
}

TEST(Homogenize, DoesNotCallASaddleStableThatTheLastStepCameTo) {
  // Only the sliding regularizer stabilizes the state at rest. At this strain the cell that does not slide is a saddle
  // point, which three Newton steps reach through states with positive definite tangents.
  HomogenizationOptions options;
  options.strain = 0.0025;
  options.directions = {7 * pi / 24};
  options.equilibrium.load_steps = 1;
  const Weave weave = interlacing_squares(SquareType::slide_both_ways);
  const auto slid = homogenize(weave, options).front();
  options.equilibrium.buckling = Switch::off;
  const auto saddle = homogenize(weave, options).front();
  EXPECT_FALSE(saddle.state.stable);
  EXPECT_TRUE(slid.state.stable);
  EXPECT_LT(slid.state.energy_density, 0.02 * saddle.state.energy_density);
}

TEST(Homogenize, SaysWhereACellFoldsFlat) {
  // Straight strands that slide form a pantograph. At 45 degrees it folds flat when its diagonal has grown by the
  // factor sqrt(2), at a strain of 0.414.
  const Weave weave = regular_weave(uniform_block(Connection::slides_x));
  const DirectionalResponse open = along(weave, 45, 0.35);
  EXPECT_EQ(open.state.stopped, Stop::converged);
  EXPECT_LT(std::abs(open.youngs_modulus), 10);
  HomogenizationOptions options;
  options.strain = 0.5;
  options.directions = {pi / 4};
  const DirectionalResponse flat = homogenize(weave, options).front();
  EXPECT_EQ(flat.state.stopped, Stop::folded_flat);
  EXPECT_TRUE(std::isnan(flat.youngs_modulus));
  EXPECT_TRUE(std::isnan(flat.poisson_ratio));
  EXPECT_TRUE(flat.state.cauchy_stress.isZero());
}

CostLedger::Effect at_limits(const std::vector<double>& directions) {
  HomogenizationOptions options;
  options.strain = 0.3;
  options.directions = directions;
  CostLedger ledger;
  Execution execution;
  execution.cost = &ledger;
  homogenize(interlacing_squares(SquareType::all_slide_x), options, execution);
  const auto found = std::find_if(ledger.effects().begin(), ledger.effects().end(),
                                  [](const CostLedger::Effect& effect) { return effect.name == "at_sliding_limits"; });
  return found == ledger.effects().end() ? CostLedger::Effect{} : *found;
}

TEST(Homogenize, BillsWhyAnEffectRanWhereItRanInSomeDirections) {
  // The squares' horizontal sides slide: along x to their limits, and along y not at all.
  EXPECT_FALSE(at_limits({pi / 2}).ran);
  const CostLedger::Effect both = at_limits({0, pi / 2});
  EXPECT_TRUE(both.ran);
  EXPECT_EQ(both.why, "sliders came within the barrier's range of their limits");
  EXPECT_EQ(both.count, at_limits({0}).count);
}

/// Sliding squares along x. With sides of 24 and 36 mm, unstable equilibria are left for branches that end at a high
/// energy.
std::vector<DirectionalResponse> squares_with_branches(double side, double strain, Switch buckling) {
  HomogenizationOptions options;
  options.strain = strain;
  options.directions = {0};
  options.equilibrium.buckling = buckling;
  return homogenize(interlacing_squares(SquareType::all_slide_x, side, side / 4), options);
}

TEST(Homogenize, DoesNotEndAboveThePathThatLeavesNoBranch) {
  for (const auto& [side, strain] : {std::pair(24.0, 0.3), std::pair(36.0, 0.25)}) {
    const CellState left = squares_with_branches(side, strain, Switch::automatic).front().state;
    const CellState straight = squares_with_branches(side, strain, Switch::off).front().state;
    EXPECT_EQ(left.stopped, Stop::converged);
    EXPECT_TRUE(left.stable);
    EXPECT_LE(left.energy_density, straight.energy_density * (1 + 1e-6)) << side;
  }
}

TEST(Homogenize, BringsSlidersThatAreStoppedToTheirLimitsWhateverTheBarriers) {
  HomogenizationOptions options;
  options.strain = 0.3;
  options.directions = {0, pi / 8, pi / 4};
  const Weave weave = interlacing_squares(SquareType::all_slide_x);
  const auto usual = homogenize(weave, options);
  options.equilibrium.barrier_range = 0.01;
  const auto narrow = homogenize(weave, options);
  options.equilibrium.barrier_range = 0.1;
  options.equilibrium.limit_tolerance = 1;
  const auto soft = homogenize(weave, options);
  for (std::size_t i = 0; i < usual.size(); ++i) {
    EXPECT_LE(usual[i].state.limit_error, 1e-6) << i;
    EXPECT_NEAR(usual[i].youngs_modulus / narrow[i].youngs_modulus, 1, 1e-5) << i;
    EXPECT_NEAR(usual[i].state.energy_density / narrow[i].state.energy_density, 1, 1e-5) << i;
    // Barriers alone are too stiff, and the estimated error is of the size of the true one.
    const double error = soft[i].state.energy_density / usual[i].state.energy_density - 1;
    EXPECT_GT(error, 0.01) << i;
    EXPECT_GT(soft[i].state.limit_error, 0.3 * error) << i;
    EXPECT_LT(soft[i].state.limit_error, 3 * error) << i;
  }
  // The value to which the modulus with ever narrower barriers converges.
  EXPECT_NEAR(usual[0].youngs_modulus, 294.29, 0.03);
}

TEST(ErrorEstimate, IsProportionalToTheDifferenceToHalfAsManySegmentsAndIsBilled) {
  HomogenizationOptions options;
  options.directions = {0.3, 1.1};
  options.equilibrium.segments = 8;
  options.equilibrium.error_estimate = Switch::automatic;
  CostLedger ledger;
  const Weave weave = regular_weave(uniform_block(Connection::fused));
  const auto fine = homogenize(weave, options, {.cost = &ledger});
  options.equilibrium.segments = 4;
  options.equilibrium.error_estimate = Switch::off;
  const auto coarse = homogenize(weave, options);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const double difference = std::abs(fine[i].youngs_modulus - coarse[i].youngs_modulus);
    EXPECT_NEAR(fine[i].youngs_modulus_error, 1.25 * difference, 1e-3 * difference) << i;
    const double of_poisson = std::abs(fine[i].poisson_ratio - coarse[i].poisson_ratio);
    EXPECT_NEAR(fine[i].poisson_ratio_error, 2.5 * of_poisson, 1e-3) << i;
    EXPECT_TRUE(std::isnan(coarse[i].youngs_modulus_error)) << i;
  }
  const auto effect = std::find_if(ledger.effects().begin(), ledger.effects().end(),
                                   [](const auto& e) { return e.name == "error_estimate"; });
  ASSERT_NE(effect, ledger.effects().end());
  EXPECT_TRUE(effect->ran);
  EXPECT_EQ(effect->count, 2);
}

TEST(ErrorEstimate, OfManyDirectionsComparesSomeAndCoversAll) {
  HomogenizationOptions options;
  options.directions = directions_over_half_turn(100);
  options.equilibrium.error_estimate = Switch::automatic;
  CostLedger ledger;
  const auto responses = homogenize(interlacing_squares(SquareType::all_fused), options, {.cost = &ledger});
  for (const DirectionalResponse& response : responses) {
    EXPECT_GT(response.youngs_modulus_error, 0) << response.direction;
    EXPECT_LT(response.youngs_modulus_error, 0.4 * response.youngs_modulus) << response.direction;
    EXPECT_GT(response.poisson_ratio_error, 0) << response.direction;
  }
  for (const auto& effect : ledger.effects()) {
    if (effect.name == "error_estimate") {
      EXPECT_EQ(effect.count, 24);
    }
  }
}

}  // namespace
}  // namespace supple::weave
