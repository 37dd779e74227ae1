#include "equilibria.h"

#include <gtest/gtest.h>

#include <vector>

#include "supple/neural/uniaxial.h"
#include "test_space.h"

namespace supple::design {
namespace {

const std::vector<Loading> loads{{0, 0.3}, {0.4, -0.2}, {1.3, 0.05}, {2.9, 0}, {0, 1e-6}, {1.6, 0.45}};

TEST(Equilibria, AreThoseOfASinglePath) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const TestSpace test(2, seed);
    const auto design = test.evaluator.design(test.at({0.3, 0.8}));
    Equilibria<double> equilibria(test.evaluator, loads, {});
    ASSERT_TRUE(equilibria.from_rest(design));
    for (std::size_t i = 0; i < loads.size(); ++i) {
      const auto path = neural::uniaxial_path(test.evaluator, design, loads[i].direction, std::vector{loads[i].strain});
      EXPECT_TRUE(equilibria[i].converged);
      EXPECT_LE(equilibria[i].residual, 1e-10);
      EXPECT_LT((equilibria[i].strain - path[0].strain).norm(), 1e-8) << seed << ", load " << i;
      EXPECT_LT((equilibria[i].stress - path[0].stress).norm(), 1e-7 * (1e-6 + path[0].stress.norm())) << i;
    }
  }
}

TEST(Equilibria, FollowedToOtherParametersAreThoseFromRest) {
  const TestSpace test(3, 4);
  const auto first = test.at({0.2, 0.5, 0.7});
  const auto second = test.at({0.25, 0.45, 0.75});
  Equilibria<double> followed(test.evaluator, loads, {});
  ASSERT_TRUE(followed.from_rest(test.evaluator.design(first, true)));
  const auto before = followed.evaluations();
  const Eigen::Vector3d change =
      Eigen::Map<const Eigen::Vector3d>(second.data()) - Eigen::Map<const Eigen::Vector3d>(first.data());
  const auto design = test.evaluator.design(second, true);
  ASSERT_TRUE(followed.follow(design, change));
  const auto warm = followed.evaluations() - before;
  Equilibria<double> fresh(test.evaluator, loads, {});
  ASSERT_TRUE(fresh.from_rest(design));
  for (std::size_t i = 0; i < loads.size(); ++i) EXPECT_LT((followed[i].strain - fresh[i].strain).norm(), 1e-8) << i;
  EXPECT_LT(warm, fresh.evaluations());
  EXPECT_EQ(followed.restarts(), 0);
}

TEST(Equilibria, SensitivitiesAreTheDifferencesOfEquilibria) {
  const TestSpace test(2, 5);
  const auto at = [&](double first) {
    Equilibria<double> equilibria(test.evaluator, loads, {.tolerance = 1e-11});
    EXPECT_TRUE(equilibria.from_rest(test.evaluator.design(std::vector{first, 0.5}, true)));
    return equilibria;
  };
  const double h = 1e-4;
  const auto low = at(0.2 - h);
  const auto middle = at(0.2);
  const auto high = at(0.2 + h);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const Eigen::Vector3d numeric = (high[i].strain - low[i].strain) / (2 * h);
    const Eigen::Vector3d analytic = middle.frame(i).free * middle.sensitivity(i).col(0);
    EXPECT_LT((numeric - analytic).norm(), 1e-6 * (1e-3 + analytic.norm())) << i;
  }
}

TEST(Equilibria, GoBackToTheStatesThatWereKept) {
  const TestSpace test(2, 6);
  Equilibria<double> equilibria(test.evaluator, loads, {});
  ASSERT_TRUE(equilibria.from_rest(test.evaluator.design(test.at({0.5, 0.5}), true)));
  equilibria.save();
  const Eigen::Vector3d kept = equilibria[0].strain;
  ASSERT_TRUE(equilibria.from_rest(test.evaluator.design(test.at({0.9, 0.1}), true)));
  EXPECT_NE(equilibria[0].strain, kept);
  equilibria.restore();
  EXPECT_EQ(equilibria[0].strain, kept);
}

TEST(Equilibria, SayWhichLoadsHaveNotConverged) {
  const TestSpace test(2, 7);
  Equilibria<double> equilibria(test.evaluator, loads, {.tolerance = 1e-10, .max_iterations = 0});
  EXPECT_FALSE(equilibria.from_rest(test.evaluator.design(test.at({0.5, 0.5}))));
  EXPECT_FALSE(equilibria[0].converged);
  EXPECT_TRUE(equilibria[3].converged) << "rest needs no iteration";
}

}  // namespace
}  // namespace supple::design
