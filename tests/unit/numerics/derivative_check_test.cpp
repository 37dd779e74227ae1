#include "supple/numerics/derivative_check.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>
#include <tuple>

#include "supple/base/random.h"
#include "supple/numerics/system.h"
#include "test_functions.h"

namespace supple::numerics {
namespace {

TEST(DerivativeCheck, ConfirmsTheDerivativesOfTermsAtRandomStates) {
  RandomStream random("derivative_check", 1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector2d x(random.uniform(-2, 2), random.uniform(-2, 2));
    for (const DerivativeCheck& check : {check_function(Rosenbrock(), x), check_function(DoubleWell(), x)}) {
      EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
      EXPECT_LT(check.hessian.error, 1e-9) << check.summary();
    }
  }
}

TEST(DerivativeCheck, ChoosesAStepThatSuitsAFunctionOfSmallScale) {
  // sin(1000 x): the longest step covers more than a period.
  class Wave : public Term<VectorState> {
   public:
    std::string_view name() const override { return "wave"; }
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      const Eigen::VectorXd& x = state.x;
      sum.value += std::sin(1000 * x[0]);
      if (order >= 1) sum.gradient[0] += 1000 * std::cos(1000 * x[0]);
      if (order >= 2) sum.hessian.add(0, 0, -1e6 * std::sin(1000 * x[0]));
    }
  };
  DerivativeCheckOptions options;
  options.levels = 14;
  const DerivativeCheck check = check_function(Wave(), Eigen::VectorXd::Constant(1, 0.3), options);
  EXPECT_LT(check.gradient.error, 1e-8) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-8) << check.summary();
}

TEST(DerivativeCheck, FindsTheOneWrongEntryOfAGradient) {
  class Wrong : public SpringChain {
   public:
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      SpringChain::add(state, order, sum);
      if (order >= 1) sum.gradient[3] += 1e-6;
    }
  };
  const DerivativeCheck check = check_function(Wrong(), Eigen::VectorXd::LinSpaced(6, -1, 1));
  EXPECT_EQ(check.gradient.row, 3);
  EXPECT_GT(check.gradient.error, 1e-7);
  EXPECT_GT(check.gradient.error, check.gradient.uncertainty);
  EXPECT_LT(check.hessian.error, 1e-9) << "a constant offset has no slope";
}

TEST(DerivativeCheck, FindsTheOneWrongEntryOfAHessian) {
  class Wrong : public SpringChain {
   public:
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      SpringChain::add(state, order, sum);
      if (order >= 2) sum.hessian.add(1, 4, 1e-5);
    }
  };
  const DerivativeCheck check = check_function(Wrong(), Eigen::VectorXd::LinSpaced(6, -1, 1));
  EXPECT_EQ(std::min(check.hessian.row, check.hessian.column), 1);
  EXPECT_EQ(std::max(check.hessian.row, check.hessian.column), 4);
  EXPECT_GT(check.hessian.error, 1e-7);
  EXPECT_LT(check.gradient.error, 1e-9);
}

TEST(DerivativeCheck, SaysHowUncertainItsOwnDifferencesAre) {
  class Wrong : public LogBarrier {
   public:
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      LogBarrier::add(state, order, sum);
      if (order >= 1) sum.gradient[0] += 1;
      if (order >= 2) sum.hessian.add(0, 0, 1);
    }
  };
  const DerivativeCheck check = check_function(Wrong(), Eigen::VectorXd::Constant(1, 0.7));
  for (const auto& worst : {check.gradient, check.hessian}) {
    EXPECT_GT(worst.error, 0.1);
    EXPECT_GT(worst.uncertainty, 0);
    EXPECT_LT(worst.uncertainty, 1e-6);
  }
  // A single step has nothing to compare with.
  DerivativeCheckOptions options;
  options.levels = 1;
  const DerivativeCheck single = check_function(SpringChain(), Eigen::VectorXd::LinSpaced(6, -1, 1), options);
  EXPECT_EQ(single.gradient.uncertainty, std::numeric_limits<double>::infinity());
  EXPECT_EQ(single.hessian.uncertainty, std::numeric_limits<double>::infinity());
}

TEST(DerivativeCheck, CountsANumberThatIsNotFiniteAsWrong) {
  class Broken : public SpringChain {
   public:
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      SpringChain::add(state, order, sum);
      if (order >= 1) sum.gradient[2] = std::numeric_limits<double>::quiet_NaN();
    }
  };
  const DerivativeCheck check = check_function(Broken(), Eigen::VectorXd::LinSpaced(4, -1, 1));
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
  VectorSystem system =
      system_of(Eigen::Vector2d(0.4, 0.9), {std::make_shared<Rosenbrock>(), std::make_shared<DoubleWell>()});
  const DerivativeCheck check = check_derivatives(system);
  EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-9) << check.summary();
}

/// A quadratic function whose Hessian is given as a bordered matrix, with one entry of it off by `error`.
class Bordered : public Objective {
 public:
  enum class Part { core, border, corner };
  Bordered(Part wrong, double error) : wrong_(wrong), error_(error) {
    RandomStream random("bordered", 1);
    for (Eigen::Index i = 0; i < 5; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) full_(i, j) = full_(j, i) = random.uniform(-1, 1);
  }
  Eigen::Index dimension() const override { return 5; }
  Evaluation evaluate(int order) override {
    Evaluation evaluation{0.5 * x_.dot(full_ * x_), full_ * x_, {}};
    if (order < 2) return evaluation;
    auto bordered = std::make_shared<BorderedMatrix>();
    const Eigen::MatrixXd lower = full_.topLeftCorner(3, 3).triangularView<Eigen::Lower>();
    bordered->core = lower.sparseView();
    bordered->border = full_.topRightCorner(3, 2);
    bordered->corner = full_.bottomRightCorner(2, 2);
    if (wrong_ == Part::core) bordered->core.coeffRef(2, 1) += error_;
    if (wrong_ == Part::border) bordered->border(1, 0) += error_;
    if (wrong_ == Part::corner) bordered->corner(1, 0) += error_;
    evaluation.hessian = std::move(bordered);
    return evaluation;
  }
  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    before_ = x_;
    x_ += step;
    return step;
  }
  void accept() override {}
  void reject() override { x_ = before_; }

 private:
  Eigen::MatrixXd full_ = Eigen::MatrixXd::Zero(5, 5);
  Eigen::VectorXd x_ = Eigen::VectorXd::LinSpaced(5, -1, 2), before_;
  Part wrong_;
  double error_;
};

TEST(DerivativeCheck, FindsTheOneWrongEntryOfABorderedHessian) {
  using Part = Bordered::Part;
  for (const auto& [part, row, column] :
       {std::tuple(Part::core, 1, 2), std::tuple(Part::border, 1, 3), std::tuple(Part::corner, 3, 4)}) {
    Bordered right(part, 0);
    EXPECT_LT(check_derivatives(right).hessian.error, 1e-9);
    Bordered wrong(part, 1e-5);
    const DerivativeCheck check = check_derivatives(wrong);
    EXPECT_GT(check.hessian.error, 1e-6);
    EXPECT_EQ(std::min(check.hessian.row, check.hessian.column), row);
    EXPECT_EQ(std::max(check.hessian.row, check.hessian.column), column);
  }
}

TEST(DerivativeCheck, LeavesTheTorsionOfTurningFramesOutAndStillFindsAWrongEntry) {
  Eigen::Matrix3d hessian;
  hessian << 2, 0.3, -0.1, 0.3, 1, 0.4, -0.1, 0.4, 3;
  const Eigen::Vector3d slope(1, -2, 0.5);
  for (const double wrong : {0.0, 1e-4}) {
    const LocalFunction function = [&](const Eigen::VectorXd& x, int order) {
      Evaluation evaluation;
      evaluation.value = slope.dot(x) + 0.5 * x.dot(hessian * x);
      const Eigen::Vector3d gradient = slope + hessian * x;
      const double angle = x.norm() / 2;
      evaluation.gradient =
          angle > 0 ? Eigen::VectorXd(Eigen::AngleAxisd(angle, x.normalized()) * gradient) : Eigen::VectorXd(gradient);
      if (order >= 2) {
        Eigen::MatrixXd given = hessian;
        given(0, 2) += wrong;
        given(2, 0) += wrong;
        evaluation.hessian = std::move(given);
      }
      return evaluation;
    };
    EXPECT_GT(check_derivatives(function, 3).hessian.error, 0.1) << "the frames turn";
    const DerivativeCheck check = check_derivatives(function, 3, {.frames_turn = true});
    if (wrong > 0) {
      EXPECT_NEAR(check.hessian.error, wrong / 3, 0.01 * wrong) << check.summary();
    } else {
      EXPECT_LT(check.hessian.error, 1e-9) << check.summary();
    }
  }
}

TEST(DerivativeCheck, RefusesToPassAHessianThatItWasNotGiven) {
  const LocalFunction without = [](const Eigen::VectorXd& x, int) { return Evaluation{x.squaredNorm(), 2 * x, {}}; };
  EXPECT_THROW(check_derivatives(without, 3), std::invalid_argument);
  EXPECT_LT(check_derivatives(without, 3, {.hessian = false}).gradient.error, 1e-9);
  const LocalFunction smaller = [](const Eigen::VectorXd& x, int) {
    return Evaluation{x.squaredNorm(), 2 * x, Eigen::MatrixXd(2 * Eigen::MatrixXd::Identity(2, 2))};
  };
  EXPECT_THROW(check_derivatives(smaller, 3), std::invalid_argument);
}

}  // namespace
}  // namespace supple::numerics
