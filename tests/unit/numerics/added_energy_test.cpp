// "How to add an energy" of CONTRIBUTING.md, followed to the letter: the page's file, and one line.
#include "added_energy.h"

#include <gtest/gtest.h>

#include "supple/base/random.h"
#include "supple/numerics/minimizer.h"

namespace supple::numerics {
namespace {

TEST(AddedEnergy, OfThePageHasTheDerivativesOfItsValue) {
  RandomStream random("added_energy", 1);
  PlanarSpring spring(0, 2, 10, 3);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::VectorXd x(4);
    for (double& coordinate : x) coordinate = random.uniform(-3, 3);
    const DerivativeCheck check = check_derivatives<VectorState>(spring, {x}, {.step = 1e-3});
    EXPECT_LT(check.gradient.error, 1e-8) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-7) << check.summary();
  }
}

TEST(AddedEnergy, OfThePageFindsItsEquilibriumWithoutAnyChangeOfASolver) {
  System<VectorState>::Terms terms;
  terms.push_back(std::make_shared<PlanarSpring>(0, 2, 10, 3));
  terms.push_back(std::make_shared<PlanarSpring>(2, 4, 10, 3));
  System<VectorState> chain({(Eigen::VectorXd(6) << 0, 0, 1, 1, 5, 0).finished()}, terms,
                            Unknowns({true, true, false, false, true, true}));
  const MinimizerResult result = minimize(chain, {.gradient_tolerance = 1e-10});
  EXPECT_EQ(result.stop, MinimizerTermination::converged);
  // Two springs of 3 mm over 5 mm stand as a roof, or hang as one.
  EXPECT_NEAR(chain.state().x[2], 2.5, 1e-10);
  EXPECT_NEAR(std::abs(chain.state().x[3]), std::sqrt(9 - 6.25), 1e-10);
}

}  // namespace
}  // namespace supple::numerics
