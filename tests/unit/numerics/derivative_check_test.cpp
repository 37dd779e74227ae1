#include "supple/numerics/derivative_check.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "supple/base/random.h"
#include "supple/numerics/scene.h"
#include "test_functions.h"

namespace supple::numerics {
namespace {

TEST(DerivativeCheck, ConfirmsTheDerivativesOfTermsAtRandomStates) {
  RandomStream random("derivative_check", 1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector2d x(random.uniform(-2, 2), random.uniform(-2, 2));
    for (const DerivativeCheck& check : {check_derivatives(Rosenbrock(), x), check_derivatives(DoubleWell(), x)}) {
      EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
      EXPECT_LT(check.hessian.error, 1e-9) << check.summary();
    }
  }
}

TEST(DerivativeCheck, ChoosesAStepThatSuitsAFunctionOfSmallScale) {
  // sin(1000 x): the longest step covers more than a period.
  class Wave : public Energy {
   public:
    std::string_view name() const override { return "wave"; }
    void add(const Eigen::VectorXd& x, int order, EnergySum& sum) const override {
      sum.value += std::sin(1000 * x[0]);
      if (order >= 1) sum.gradient[0] += 1000 * std::cos(1000 * x[0]);
      if (order >= 2) sum.hessian.add(0, 0, -1e6 * std::sin(1000 * x[0]));
    }
  };
  DerivativeCheckOptions options;
  options.levels = 14;
  const DerivativeCheck check = check_derivatives(Wave(), Eigen::VectorXd::Constant(1, 0.3), options);
  EXPECT_LT(check.gradient.error, 1e-8) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-8) << check.summary();
}

TEST(DerivativeCheck, FindsTheOneWrongEntryOfAGradient) {
  class Wrong : public SpringChain {
   public:
    void add(const Eigen::VectorXd& x, int order, EnergySum& sum) const override {
      SpringChain::add(x, order, sum);
      if (order >= 1) sum.gradient[3] += 1e-6;
    }
  };
  const DerivativeCheck check = check_derivatives(Wrong(), Eigen::VectorXd::LinSpaced(6, -1, 1));
  EXPECT_EQ(check.gradient.row, 3);
  EXPECT_GT(check.gradient.error, 1e-7);
  EXPECT_GT(check.gradient.error, check.gradient.uncertainty);
  EXPECT_LT(check.hessian.error, 1e-9) << "a constant offset has no slope";
}

TEST(DerivativeCheck, FindsTheOneWrongEntryOfAHessian) {
  class Wrong : public SpringChain {
   public:
    void add(const Eigen::VectorXd& x, int order, EnergySum& sum) const override {
      SpringChain::add(x, order, sum);
      if (order >= 2) sum.hessian.add(1, 4, 1e-5);
    }
  };
  const DerivativeCheck check = check_derivatives(Wrong(), Eigen::VectorXd::LinSpaced(6, -1, 1));
  EXPECT_EQ(std::min(check.hessian.row, check.hessian.column), 1);
  EXPECT_EQ(std::max(check.hessian.row, check.hessian.column), 4);
  EXPECT_GT(check.hessian.error, 1e-7);
  EXPECT_LT(check.gradient.error, 1e-9);
}

TEST(DerivativeCheck, CountsANumberThatIsNotFiniteAsWrong) {
  class Broken : public SpringChain {
   public:
    void add(const Eigen::VectorXd& x, int order, EnergySum& sum) const override {
      SpringChain::add(x, order, sum);
      if (order >= 1) sum.gradient[2] = std::numeric_limits<double>::quiet_NaN();
    }
  };
  const DerivativeCheck check = check_derivatives(Broken(), Eigen::VectorXd::LinSpaced(4, -1, 1));
  EXPECT_EQ(check.gradient.row, 2);
  EXPECT_GT(check.gradient.error, 1);
}

TEST(DerivativeCheck, WorksAlongTheRetractionOfAManifold) {
  RandomStream random("manifold_check", 1);
  for (int trial = 0; trial < 10; ++trial) {
    Eigen::Matrix3d a;
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = random.normal();
    a = (a + a.transpose()).eval();
    RayleighQuotient quotient(a, Eigen::Vector3d(random.normal(), random.normal(), random.normal()));
    const DerivativeCheck check = check_derivatives(quotient);
    EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
    EXPECT_LT(check.hessian.error, 1e-9) << check.summary();
  }
}

TEST(DerivativeCheck, ChecksASceneOfSeveralTermsAsAWhole) {
  Scene scene(Eigen::Vector2d(0.4, 0.9), {std::make_shared<Rosenbrock>(), std::make_shared<DoubleWell>()});
  const DerivativeCheck check = check_derivatives(scene);
  EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-9) << check.summary();
}

}  // namespace
}  // namespace supple::numerics
