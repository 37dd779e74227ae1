#include "supple/numerics/minimizer.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <memory>

#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/numerics/system.h"
#include "support/expect_error.h"
#include "test_functions.h"

namespace supple::numerics {
namespace {

MinimizerOptions with_method(MinimizerMethod method, int max_iterations = 200) {
  MinimizerOptions options;
  options.method = method;
  options.max_iterations = max_iterations;
  return options;
}

/// The line through a well where the objective is smooth but for one kink, |x0| + x1^2 / 2, which it can snap to.
class Crease : public Objective {
 public:
  explicit Crease(Eigen::Vector2d x) : x_(std::move(x)), trial_(x_) {}
  Eigen::Index dimension() const override { return 2; }
  Evaluation evaluate(int order) override {
    Evaluation e;
    e.value = std::abs(trial_[0]) + 0.5 * trial_[1] * trial_[1];
    // At the kink the gradient is the shortest of all subgradients.
    const double side = trial_[0] > 0 ? 1 : trial_[0] < 0 ? -1 : 0;
    if (order >= 1) e.gradient = Eigen::Vector2d(side, trial_[1]);
    if (order >= 2) e.hessian = Eigen::MatrixXd(Eigen::Matrix2d::Identity());
    return e;
  }
  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    trial_ = x_ + step;
    return step;
  }
  void accept() override { x_ = trial_; }
  void reject() override { trial_ = x_; }
  std::optional<double> try_nonsmooth_candidates() override {
    if (trial_[0] == 0) return std::nullopt;
    ++candidates_taken;
    trial_[0] = 0;
    return (trial_ - x_).norm();
  }
  const Eigen::Vector2d& x() const { return x_; }
  int candidates_taken = 0;

 private:
  Eigen::Vector2d x_;
  Eigen::Vector2d trial_;
};

TEST(Minimizer, LbfgsTakesStepsThatAreLongEnoughForTheSlopeToRise) {
  // Along -g the slope of |x0| + x1^2 / 2 at (10, 2) is -5 + 4 t: it has risen to 0.9 of its start at t = 1 / 8.
  MinimizerOptions options = with_method(MinimizerMethod::lbfgs, 1);
  options.first_step = 1e-3;
  Crease without(Eigen::Vector2d(10, 2));
  EXPECT_LT(minimize(without, options).history[1].step_length, 0.01);
  options.slope_contraction = 0.9;
  Crease crease(Eigen::Vector2d(10, 2));
  EXPECT_GT(minimize(crease, options).history[1].step_length, 0.1);
}

TEST(Minimizer, LbfgsWithSlopesThatMustRiseFindsSmoothMinima) {
  VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(-1.2, 1));
  MinimizerOptions options = with_method(MinimizerMethod::lbfgs, 300);
  options.slope_contraction = 0.9;
  EXPECT_EQ(minimize(system, options).stop, MinimizerTermination::converged);
  EXPECT_LT((system.state().x - Eigen::Vector2d(1, 1)).norm(), 1e-6);
}

TEST(Minimizer, NewtonFindsTheMinimumOfRosenbrocksValley) {
  VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(-1.2, 1));
  const MinimizerResult result = minimize(system, with_method(MinimizerMethod::newton));
  EXPECT_EQ(result.stop, MinimizerTermination::converged);
  EXPECT_LE(result.gradient_norm, 1e-9);
  EXPECT_LT((system.state().x - Eigen::Vector2d(1, 1)).norm(), 1e-9);
  EXPECT_LE(result.iterations, 30);
}

TEST(Minimizer, EveryMethodReachesTheSameMinimum) {
  for (const auto method : {MinimizerMethod::newton, MinimizerMethod::lbfgs, MinimizerMethod::gradient_descent}) {
    VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(-1.2, 1));
    const MinimizerResult result = minimize(system, with_method(method, 20000));
    EXPECT_EQ(result.stop, MinimizerTermination::converged) << static_cast<int>(method);
    EXPECT_LT((system.state().x - Eigen::Vector2d(1, 1)).norm(), 1e-8) << static_cast<int>(method);
  }
}

TEST(Minimizer, LbfgsNeedsFewerIterationsThanGradientDescentAndMoreThanNewton) {
  const auto iterations = [](MinimizerMethod method) {
    VectorSystem system = system_of<SpringChain>(Eigen::VectorXd::Zero(50));
    return minimize(system, with_method(method, 5000)).iterations;
  };
  const int newton = iterations(MinimizerMethod::newton);
  const int lbfgs = iterations(MinimizerMethod::lbfgs);
  const int descent = iterations(MinimizerMethod::gradient_descent);
  EXPECT_EQ(newton, 1);
  EXPECT_LT(newton, lbfgs);
  EXPECT_LT(lbfgs, descent);
}

TEST(Minimizer, ValuesNeverRise) {
  for (const auto method : {MinimizerMethod::newton, MinimizerMethod::lbfgs, MinimizerMethod::gradient_descent}) {
    VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(-1.2, 1));
    const MinimizerResult result = minimize(system, with_method(method, 300));
    ASSERT_EQ(result.history.size(), static_cast<std::size_t>(result.iterations) + 1);
    for (std::size_t i = 1; i < result.history.size(); ++i)
      EXPECT_LE(result.history[i].value, result.history[i - 1].value) << "iteration " << i;
  }
}

TEST(Minimizer, TellsOfEveryStateWhenItIsTheCurrentOne) {
  VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(-1.2, 1));
  MinimizerOptions options = with_method(MinimizerMethod::newton);
  std::vector<double> told;
  options.after_step = [&](const MinimizerStep& step) {
    told.push_back(step.value);
    const Eigen::VectorXd& x = system.state().x;
    EXPECT_NEAR(step.value, 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2), 1e-12 * step.value);
  };
  const MinimizerResult result = minimize(system, options);
  ASSERT_EQ(told.size(), result.history.size());
  for (std::size_t i = 0; i < told.size(); ++i) EXPECT_EQ(told[i], result.history[i].value);
}

/// A double well of each unknown, one of them a hundred thousand times as stiff: it may give its Hessian without what
/// is negative.
class Wells : public Term<VectorState> {
 public:
  explicit Wells(bool convex) : convex_(convex) {}
  std::string_view name() const override { return "wells"; }
  bool has_convex_hessian() const override { return convex_; }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    for (Eigen::Index i = 0; i < state.x.size(); ++i) {
      const double x = state.x[i];
      const double stiffness = i == 0 ? 1e5 : 1;
      sum.value += stiffness * (x * x - 1) * (x * x - 1);
      if (order >= 1) sum.gradient[i] += stiffness * 4 * x * (x * x - 1);
      const double curvature = stiffness * (12 * x * x - 4);
      if (order >= 2) sum.hessian.add(i, i, sum.convex ? std::max(curvature, 4 * stiffness * x * x) : curvature);
    }
  }

 private:
  bool convex_;
};

TEST(Minimizer, NewtonTakesTheConvexMatrixOfAnObjectiveThatHasOne) {
  int iterations[2] = {0, 0};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream random("wells", seed);
    Eigen::VectorXd start(6);
    for (double& x : start) x = random.uniform(-0.3, 0.3);
    start[0] = 0.9;
    for (const bool convex : {false, true}) {
      VectorSystem system = system_of(start, {std::make_shared<Wells>(convex)});
      const MinimizerResult result = minimize(system, with_method(MinimizerMethod::newton));
      EXPECT_EQ(result.stop, MinimizerTermination::converged);
      EXPECT_TRUE(result.indefinite);
      EXPECT_LT((system.state().x.cwiseAbs() - Eigen::VectorXd::Ones(6)).norm(), 1e-6);
      const bool regularized =
          std::ranges::any_of(result.history, [](const MinimizerStep& step) { return step.regularization > 0; });
      EXPECT_EQ(regularized, !convex);
      iterations[convex ? 1 : 0] += result.iterations;
      // The Hessian itself is as before, and so is the energy.
      EXPECT_LT(check_derivatives(system).hessian.error, 1e-8);
    }
  }
  EXPECT_LT(iterations[1], iterations[0]);
}

TEST(Minimizer, NewtonRegularizesAnIndefiniteStartAndLeavesTheSaddle) {
  VectorSystem system = system_of<DoubleWell>(Eigen::Vector2d(0.01, 1));
  const MinimizerResult result = minimize(system, with_method(MinimizerMethod::newton));
  EXPECT_EQ(result.stop, MinimizerTermination::converged);
  EXPECT_NEAR(system.state().x[0], 1, 1e-9);
  EXPECT_GT(result.history[1].regularization, 0);
  EXPECT_LT(result.history.back().regularization, 1e-4 * result.history[1].regularization)
      << "regularization should fade where it is not needed";
}

TEST(Minimizer, TriesLongerStepsWhereTheMatrixIsRoughButNotBeyondTheLimit) {
  /// -log(1 + x^2), which falls for ever.
  class Hill : public Term<VectorState> {
   public:
    std::string_view name() const override { return "hill"; }
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      const double x = state.x[0];
      const double a = 1 + x * x;
      sum.value -= std::log(a);
      if (order >= 1) sum.gradient[0] -= 2 * x / a;
      if (order >= 2) sum.hessian.add(0, 0, 2 * (x * x - 1) / (a * a));
    }
  };
  const auto first_step = [](double longest) {
    VectorSystem system = system_of<Hill>(Eigen::VectorXd::Constant(1, 0.1));
    MinimizerOptions options = with_method(MinimizerMethod::newton, 1);
    options.max_expansion = longest;
    return minimize(system, options).history.at(1).step_length;
  };
  const double once = first_step(1);
  EXPECT_GT(once, 0);
  EXPECT_NEAR(first_step(1.9), once, 1e-12 * once);
  for (const int times : {2, 4, 16}) EXPECT_NEAR(first_step(times), times * once, 1e-12 * times * once);
}

TEST(Minimizer, StopsOnItsWayToASaddleIfAskedTo) {
  // From (0, y) symmetry keeps the search on the ridge between the wells: its end is the saddle.
  MinimizerOptions options = with_method(MinimizerMethod::newton, 2000);
  VectorSystem to_the_saddle = system_of<DoubleWell>(Eigen::Vector2d(0, 1));
  const MinimizerResult all = minimize(to_the_saddle, options);
  EXPECT_EQ(all.stop, MinimizerTermination::converged);
  EXPECT_TRUE(all.indefinite);
  EXPECT_EQ(to_the_saddle.state().x[0], 0);
  options.saddle_contraction = 0.1;
  VectorSystem system = system_of<DoubleWell>(Eigen::Vector2d(0, 1));
  const MinimizerResult result = minimize(system, options);
  EXPECT_EQ(result.stop, MinimizerTermination::saddle);
  EXPECT_LE(result.gradient_norm, 0.1 * result.history.front().gradient_norm);
  EXPECT_GT(result.gradient_norm, options.gradient_tolerance);
  // Where the search finds its own way down, nothing changes.
  VectorSystem down = system_of<DoubleWell>(Eigen::Vector2d(0.5, 1));
  EXPECT_EQ(minimize(down, options).stop, MinimizerTermination::converged);
}

TEST(Minimizer, NewtonsLastStepsSquareTheGradient) {
  VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(0.9, 0.7));
  const MinimizerResult result = minimize(system, with_method(MinimizerMethod::newton));
  ASSERT_EQ(result.stop, MinimizerTermination::converged);
  const std::size_t n = result.history.size();
  ASSERT_GE(n, 3u);
  const double before = result.history[n - 2].gradient_norm;
  EXPECT_LT(before, 1e-2);
  EXPECT_LE(result.history[n - 1].gradient_norm, 100 * before * before);
}

TEST(Minimizer, ReachesTheRoundingLevelWhereTheValueShowsNoDecreaseAnyMore) {
  // On top of 1e8, decreases below about 1e-8 cannot be seen in the value; the gradient still shows the way.
  class OnAPlateau : public SpringChain {
   public:
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      SpringChain::add(state, order, sum);
      sum.value += 1e8;
    }
  };
  for (const auto method : {MinimizerMethod::newton, MinimizerMethod::lbfgs}) {
    VectorSystem system = system_of<OnAPlateau>(Eigen::VectorXd::Constant(20, 1e-3));
    const MinimizerResult result = minimize(system, with_method(method));
    EXPECT_EQ(result.stop, MinimizerTermination::converged);
    EXPECT_LE(result.gradient_norm, 1e-9);
  }
}

TEST(Minimizer, FindsTheLeastEigenvectorOnTheSphereByEveryMethod) {
  RandomStream random("rayleigh", 1);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::Matrix3d a;
    Eigen::Vector3d x;
    for (int i = 0; i < 3; ++i) {
      x[i] = random.normal();
      for (int j = 0; j < 3; ++j) a(i, j) = random.normal();
    }
    a = (a + a.transpose()).eval();
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(a).eigenvalues()[0];
    for (const auto method : {MinimizerMethod::newton, MinimizerMethod::lbfgs, MinimizerMethod::gradient_descent}) {
      RayleighQuotient quotient(a, x);
      const MinimizerResult result = minimize(quotient, with_method(method, 2000));
      EXPECT_EQ(result.stop, MinimizerTermination::converged) << trial;
      EXPECT_NEAR(2 * result.value, least, 1e-9) << trial;
    }
  }
}

TEST(Minimizer, NeverTriesAStepBeyondTheLargestValidOne) {
  class Watched : public LogBarrier {
   public:
    explicit Watched(double* least) : least_(least) {}
    void add(const VectorState& state, int order, EnergySum& sum) const override {
      const Eigen::VectorXd& x = state.x;
      *least_ = std::min(*least_, x[0]);
      LogBarrier::add(state, order, sum);
    }

   private:
    double* least_;
  };
  double least = 1;
  // From 30 the Newton step would lead to x = 30 - 870.
  VectorSystem system = system_of(Eigen::VectorXd::Constant(1, 30.0), {std::make_shared<Watched>(&least)});
  const MinimizerResult result = minimize(system);
  EXPECT_EQ(result.stop, MinimizerTermination::converged);
  EXPECT_NEAR(system.state().x[0], 1, 1e-9);
  EXPECT_GT(least, 0) << "a state outside the domain was evaluated";
}

TEST(Minimizer, SnapsToAKinkThatItsLineSearchCannotReach) {
  Crease crease(Eigen::Vector2d(0.3, 1));
  const MinimizerResult result = minimize(crease);
  EXPECT_EQ(result.stop, MinimizerTermination::converged);
  EXPECT_EQ(crease.x(), Eigen::Vector2d(0, 0));
  EXPECT_GE(crease.candidates_taken, 1);
}

/// Promises a decrease of 1 in each step, which the line search does not find; a kink gives a little of it.
class Creeping : public Objective {
 public:
  explicit Creeping(double gain) : gain_(gain) {}
  Eigen::Index dimension() const override { return 1; }
  Evaluation evaluate(int order) override {
    Evaluation e;
    e.value = is_trial_ ? 1 : -gain_ * steps_;
    if (order >= 1) e.gradient = Eigen::VectorXd::Constant(1, 1.0);
    if (order >= 2) e.hessian = Eigen::MatrixXd(Eigen::MatrixXd::Identity(1, 1));
    return e;
  }
  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    is_trial_ = true;
    return step;
  }
  void accept() override {}
  void reject() override { is_trial_ = false; }
  std::optional<double> try_nonsmooth_candidates() override {
    ++steps_;
    return 1e-3;
  }

 private:
  double gain_;
  int steps_ = 0;
  bool is_trial_ = false;
};

TEST(Minimizer, EndsStepsThatCreepAfterItHasRegularizedThem) {
  MinimizerOptions options;
  Creeping without(1e-18);
  EXPECT_EQ(minimize(without, options).stop, MinimizerTermination::iteration_limit);
  options.stagnation_fraction = 1e-3;
  Creeping creeping(1e-18);
  const MinimizerResult result = minimize(creeping, options);
  EXPECT_EQ(result.stop, MinimizerTermination::step_too_small);
  EXPECT_EQ(result.iterations, options.max_stagnant_steps);
  const auto regularization = [&](int step) {
    return result.history[static_cast<std::size_t>(options.stagnant_steps_without_regularization + step)]
        .regularization;
  };
  EXPECT_EQ(regularization(1), 0);
  for (int step = 2; step < 12; ++step) EXPECT_GT(regularization(step), regularization(step - 1));
  // Steps that fall by more than the share go on, and so do those whose decrease rounding hides.
  Creeping walking(1.1e-3);
  EXPECT_EQ(minimize(walking, options).stop, MinimizerTermination::iteration_limit);
  Creeping rounding(1e-18);
  options.value_rounding = 1e20;
  EXPECT_EQ(minimize(rounding, options).stop, MinimizerTermination::iteration_limit);
}

TEST(Minimizer, EndsAfterAFewStepsThatLeaveStateAndValueAsTheyAre) {
  class InPlace : public Creeping {
   public:
    InPlace() : Creeping(0) {}
    std::optional<double> try_nonsmooth_candidates() override {
      Creeping::try_nonsmooth_candidates();
      return 0;
    }
  };
  InPlace standing;
  const MinimizerResult result = minimize(standing);
  EXPECT_EQ(result.stop, MinimizerTermination::step_too_small);
  EXPECT_EQ(result.iterations, 3);
}

TEST(Minimizer, SaysThatItCameToTheIterationLimit) {
  VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(-1.2, 1));
  const MinimizerResult result = minimize(system, with_method(MinimizerMethod::newton, 3));
  EXPECT_EQ(result.stop, MinimizerTermination::iteration_limit);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_EQ(result.history.size(), 4u);
}

TEST(Minimizer, SaysThatNoStepIsLeftWhereTheToleranceCannotBeReached) {
  VectorSystem system = system_of<SpringChain>(Eigen::VectorXd::Zero(30));
  MinimizerOptions options;
  options.gradient_tolerance = 0;
  EXPECT_EQ(minimize(system, options).stop, MinimizerTermination::step_too_small);
}

TEST(Minimizer, RefusesAStartWithoutAFiniteValue) {
  VectorSystem system = system_of<LogBarrier>(Eigen::VectorXd::Constant(1, -1.0));
  try {
    minimize(system);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "minimizer.not_finite");
  }
}

TEST(Minimizer, StopsWhenItIsCancelledInMidSearch) {
  class CancelAtThird : public ProgressSink {
   public:
    explicit CancelAtThird(CancellationToken token) : token_(std::move(token)) {}
    void report(double fraction, std::string_view) override {
      EXPECT_GE(fraction, last_);
      last_ = fraction;
      if (++reports == 3) token_.request(StopReason::cancelled);
    }
    int reports = 0;

   private:
    CancellationToken token_;
    double last_ = 0;
  };
  Execution execution;
  CancelAtThird sink(execution.cancellation);
  execution.progress = &sink;
  VectorSystem system = system_of<Rosenbrock>(Eigen::Vector2d(-1.2, 1));
  testing::expect_cancelled(StopReason::cancelled, [&] { minimize(system, {}, execution); });
  EXPECT_EQ(sink.reports, 3);
}

TEST(Minimizer, BillsEveryTermOfAScene) {
  CostLedger cost;
  VectorSystem system =
      system_of(Eigen::VectorXd::Zero(5), {std::make_shared<SpringChain>(), std::make_shared<LogBarrier>()}, &cost);
  system.move(Eigen::VectorXd::Ones(5));
  system.accept();
  minimize(system);
  ASSERT_EQ(cost.effects().size(), 2u);
  EXPECT_EQ(cost.effects()[0].name, "spring_chain");
  EXPECT_EQ(cost.effects()[1].name, "log_barrier");
  EXPECT_TRUE(cost.effects()[0].ran);
  EXPECT_GE(cost.effects()[0].count, 3);
  EXPECT_EQ(cost.effects()[0].count, cost.effects()[1].count);
}

TEST(Newton, ReusesAFactorizationThatContractsAndComesToTheSameMinimum) {
  MinimizerOptions options;
  options.gradient_tolerance = 1e-12;
  const Eigen::Vector2d start(1.2, 1.1);
  VectorSystem fresh = system_of<Rosenbrock>(start);
  const MinimizerResult with_all = minimize(fresh, options);
  options.reuse_contraction = 0.5;
  CostLedger cost;
  VectorSystem reused = system_of<Rosenbrock>(start, &cost);
  ShiftedCholesky cholesky;
  const MinimizerResult with_few = minimize(reused, options, {}, &cholesky);
  EXPECT_EQ(with_few.stop, MinimizerTermination::converged);
  EXPECT_LT((fresh.state().x - reused.state().x).norm(), 1e-12);
  EXPECT_GT(with_few.iterations, with_all.iterations) << "no step was made with an old factorization";
  // The factorization that is left is of the state that the result names.
  ASSERT_GE(with_few.factorized_at, 0);
  EXPECT_LT(with_few.factorized_at, with_few.iterations - 1);
}

/// (1 - x0)^2 + 100 (x1 - x0^2)^2, with the defaults of an objective in a vector space.
class Valley : public Objective {
 public:
  Eigen::Index dimension() const override { return 2; }
  Evaluation evaluate(int order) override {
    const Eigen::Vector2d& at = moving_ ? trial_ : x_;
    Evaluation e;
    const double across = at[1] - at[0] * at[0];
    e.value = (1 - at[0]) * (1 - at[0]) + 100 * across * across;
    if (order >= 1) e.gradient = Eigen::Vector2d(-2 * (1 - at[0]) - 400 * at[0] * across, 200 * across);
    return e;
  }
  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    trial_ = x_ + step;
    moving_ = true;
    return step;
  }
  void accept() override {
    x_ = trial_;
    moving_ = false;
  }
  void reject() override { moving_ = false; }

 private:
  Eigen::Vector2d x_{-1.2, 1};
  Eigen::Vector2d trial_{0, 0};
  bool moving_ = false;
};

TEST(Minimizer, KeepsWhatItLearnedOfTheCurvatureInAVectorSpace) {
  const auto iterations = [](MinimizerMethod method) {
    Valley valley;
    const auto result = minimize(valley, {.method = method, .gradient_tolerance = 1e-8, .max_iterations = 10'000});
    EXPECT_EQ(result.stop, MinimizerTermination::converged);
    return result.iterations;
  };
  EXPECT_LT(2 * iterations(MinimizerMethod::lbfgs), iterations(MinimizerMethod::gradient_descent));
}

TEST(MinimizerStops, HaveNames) {
  EXPECT_EQ(to_string(MinimizerTermination::converged), "converged");
  EXPECT_EQ(to_string(MinimizerTermination::step_too_small), "step_too_small");
  EXPECT_EQ(to_string(MinimizerTermination::saddle), "saddle");
  EXPECT_EQ(to_string(MinimizerTermination::iteration_limit), "iteration_limit");
}

}  // namespace
}  // namespace supple::numerics
