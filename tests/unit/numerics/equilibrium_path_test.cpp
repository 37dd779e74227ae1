#include "supple/numerics/equilibrium_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "supple/base/error.h"

namespace supple::numerics {
namespace {

/// E(x, y) = x^4 / 4 - load x^2 / 2 - tilt x + (y - load)^2 / 2. With tilt 0 the branch x = 0 loses its stability at
/// load 0 to the two branches x = +-sqrt(load); y follows the load.
class Pitchfork : public Objective {
 public:
  double load = -1, tilt = 0;
  bool stiffness_is_known = true;
  Eigen::Vector2d x{0, -1};

  Eigen::Index dimension() const override { return 2; }
  Evaluation evaluate(int order) override {
    const Eigen::Vector2d& at = trial_ ? moved_ : x;
    Evaluation e;
    e.value = std::pow(at[0], 4) / 4 - load * at[0] * at[0] / 2 - tilt * at[0] + std::pow(at[1] - load, 2) / 2;
    if (order >= 1) e.gradient = Eigen::Vector2d(std::pow(at[0], 3) - load * at[0] - tilt, at[1] - load);
    if (order >= 2) {
      Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(2, 2);
      hessian(0, 0) = stiffness_is_known ? 3 * at[0] * at[0] - load : std::numeric_limits<double>::quiet_NaN();
      e.hessian = std::move(hessian);
    }
    return e;
  }
  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    moved_ = x + step;
    trial_ = true;
    return step;
  }
  void accept() override {
    x = moved_;
    trial_ = false;
  }
  void reject() override { trial_ = false; }

 private:
  Eigen::Vector2d moved_{0, 0};
  bool trial_ = false;
};

/// The load changes from `from` to `to`; loads beyond what `bearable` allows from one step to the next have no
/// prediction.
class PitchforkScene {
 public:
  struct State {
    Eigen::Vector2d x;
    double load;
  };
  Pitchfork& objective() { return pitchfork; }
  ShiftedCholesky& cholesky() { return cholesky_; }
  State state() const { return {pitchfork.x, pitchfork.load}; }
  void set_state(const State& state) {
    pitchfork.x = state.x;
    pitchfork.load = state.load;
  }
  double gradient_tolerance() const { return 1e-12; }
  bool must_minimize_again(const MinimizerResult&) { return repeats > 0 && repeats-- > 0; }
  bool finish(const MinimizerResult&) { return cholesky_.factorize(pitchfork.evaluate(2).hessian, 0); }
  bool finish_unstable() { return true; }
  void begin_step() { start_ = pitchfork.load; }
  bool predict(double share) {
    ++predictions;
    const double change = share * (target - start_);
    if (change > bearable) return false;
    pitchfork.load = start_ + change;
    pitchfork.x[1] = pitchfork.load;  // exactly, so that an unstable branch can be followed by Newton's method too
    return true;
  }
  void finish_load_step(const LoadStepResult& arrival) { arrivals.push_back(arrival); }
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const { return y; }
  Eigen::VectorXd unit_mode(const Eigen::VectorXd& mode) const { return mode; }
  bool move_along(const State& from, const Eigen::VectorXd& mode, double amount) {
    if (std::abs(amount) > reach) return false;
    pitchfork.x = from.x + amount * mode;
    return true;
  }
  void left_branch() { ++left; }

  Pitchfork pitchfork;
  double target = 1, bearable = 10, reach = 10;
  int repeats = 0, predictions = 0, left = 0;
  std::vector<LoadStepResult> arrivals;

 private:
  ShiftedCholesky cholesky_;
  double start_ = 0;
};

using Path = EquilibriumPath<PitchforkScene>;

/// All steps to the target; false where one failed.
bool follow(PitchforkScene& scene, Path& path) {
  while (true) {
    const auto progress = path.step(std::abs(scene.target - scene.pitchfork.load));
    if (progress != Path::Progress::partial) return progress == Path::Progress::complete;
  }
}

TEST(EquilibriumPath, LeavesABranchWhereItLosesItsStabilityForTheLowerOne) {
  PitchforkScene scene;
  Path path(scene, {.largest_step = 0.3}, {});
  ASSERT_TRUE(path.find_equilibrium());
  ASSERT_TRUE(follow(scene, path));
  EXPECT_NEAR(std::abs(scene.pitchfork.x[0]), 1, 1e-12);
  EXPECT_NEAR(scene.pitchfork.x[1], 1, 1e-12);
  EXPECT_TRUE(path.stable());
  EXPECT_EQ(path.counts().branches_left, 1);
  EXPECT_EQ(scene.left, 1);
  EXPECT_EQ(path.counts().load_steps, 7);
  int others = 0;
  for (const LoadStepResult& arrival : scene.arrivals) {
    EXPECT_EQ(arrival.same_branch, !arrival.indefinite)
        << "this path meets an indefinite Hessian where it branches only";
    others += arrival.same_branch ? 0 : 1;
  }
  EXPECT_EQ(others, 1);
}

TEST(EquilibriumPath, ReportsAnUnstableEquilibriumWhereItIsNotToLeaveIt) {
  PitchforkScene scene;
  Path path(scene, {.largest_step = 0.3, .leave_unstable = false}, {});
  ASSERT_TRUE(follow(scene, path));
  EXPECT_EQ(scene.pitchfork.x[0], 0);
  EXPECT_FALSE(path.stable());
  EXPECT_EQ(path.counts().branches_left, 0);
}

TEST(EquilibriumPath, AllowsMoreIterationsAfterItLeftABranch) {
  for (const int times : {1, 20}) {
    PitchforkScene scene;
    scene.pitchfork.load = 1;
    scene.pitchfork.x = {0, 1};
    Path path(scene, {.max_iterations = 1, .iteration_factor_after_leaving = times}, {});
    EXPECT_EQ(path.find_equilibrium(), times > 1);
    EXPECT_EQ(path.stopped(), times > 1 ? PathTermination::converged : PathTermination::iteration_limit);
    EXPECT_EQ(scene.left, 1);
  }
}

TEST(EquilibriumPath, LeavesABranchNoMoreOftenThanItMay) {
  PitchforkScene scene;
  Path path(scene, {.largest_step = 0.3, .max_branch_changes = 0}, {});
  ASSERT_TRUE(follow(scene, path));
  EXPECT_EQ(scene.pitchfork.x[0], 0);
  EXPECT_FALSE(path.stable());
}

TEST(EquilibriumPath, StaysWhereNoStepAlongTheModeIsAllowed) {
  PitchforkScene scene;
  scene.reach = 1e-6;
  Path path(scene, {.largest_step = 0.3}, {});
  ASSERT_TRUE(follow(scene, path));
  EXPECT_EQ(scene.pitchfork.x[0], 0);
  EXPECT_FALSE(path.stable());
  EXPECT_EQ(scene.left, 0);
}

TEST(EquilibriumPath, CallsRoundingOfACurvatureStable) {
  PitchforkScene scene;
  // The curvature along x is -1e-14, the scale of the matrix about 1.
  scene.pitchfork.load = 1e-14;
  scene.pitchfork.x = {0, 1e-14};
  Path path(scene, {}, {});
  ASSERT_TRUE(path.find_equilibrium());
  EXPECT_TRUE(path.stable());
  EXPECT_EQ(path.counts().branches_left, 0);
}

TEST(EquilibriumPath, HalvesStepsThatFailAndLetsQuickOnesGrow) {
  PitchforkScene scene;
  scene.pitchfork.load = -3;
  scene.target = -1;
  scene.bearable = 0.3;
  Path path(scene, {.largest_step = 2}, {});
  ASSERT_TRUE(follow(scene, path));
  EXPECT_EQ(scene.pitchfork.load, -1);
  // 2 -> 1 -> 0.5 -> 0.25; then each step of 0.25 lets the next one be 0.5 long, which fails and is halved again.
  EXPECT_EQ(path.counts().load_steps, 8);
  EXPECT_EQ(scene.predictions, 3 + 8 + 6) << "the last step is as long as what remains";
}

TEST(EquilibriumPath, GoesBackToTheLastEquilibriumWhereTheSmallestStepFails) {
  PitchforkScene scene;
  scene.bearable = 0;
  Path path(scene, {.largest_step = 1, .smallest_step = 1e-3}, {});
  ASSERT_TRUE(path.find_equilibrium());
  const auto before = path.snapshot();
  EXPECT_FALSE(follow(scene, path));
  EXPECT_EQ(path.stopped(), PathTermination::step_too_small);
  EXPECT_EQ(scene.pitchfork.load, -1);
  EXPECT_EQ(scene.pitchfork.x, before.state.x);
  EXPECT_EQ(path.counts().load_steps, 0);
  EXPECT_TRUE(path.stable());
}

TEST(EquilibriumPath, SaysThatIterationsRanOut) {
  PitchforkScene scene;
  scene.pitchfork.tilt = 0.1;
  Path path(scene, {.max_iterations = 1, .largest_step = 2, .smallest_step = 1.5}, {});
  EXPECT_FALSE(follow(scene, path));
  EXPECT_EQ(path.stopped(), PathTermination::iteration_limit);
}

TEST(EquilibriumPath, MinimizesAgainWhileTheSceneIsNotSettled) {
  PitchforkScene scene;
  scene.repeats = 3;
  Path path(scene, {}, {});
  EXPECT_TRUE(path.find_equilibrium());
  EXPECT_EQ(scene.repeats, 0);
}

TEST(EquilibriumPath, RefusesASceneThatDoesNotSettle) {
  PitchforkScene scene;
  scene.repeats = 1'000'000;
  Path path(scene, {}, {});
  EXPECT_FALSE(path.find_equilibrium());
  EXPECT_EQ(path.stopped(), PathTermination::iteration_limit);
  EXPECT_GT(scene.repeats, 1'000'000 - 100) << "it does not repeat for ever";
}

TEST(EquilibriumPath, CallsAnEquilibriumWhoseStiffnessIsNotFiniteUnstable) {
  PitchforkScene scene;
  scene.pitchfork.stiffness_is_known = false;
  Path path(scene, {}, {});
  EXPECT_TRUE(path.find_equilibrium());
  EXPECT_FALSE(path.stable());
  EXPECT_EQ(scene.left, 0);
}

TEST(EquilibriumPath, GoesOverToAnotherEquilibriumOnlyIfItIsLower) {
  PitchforkScene scene;
  scene.pitchfork.load = 1;
  scene.pitchfork.tilt = 0.1;
  scene.pitchfork.x = {-0.9, 1};
  Path path(scene, {}, {});
  ASSERT_TRUE(path.find_equilibrium());
  const double upper = scene.pitchfork.x[0];
  EXPECT_LT(upper, 0);
  EXPECT_FALSE(path.prefer_lower_from({{-1.2, 1}, 1}, 1e-9)) << "it leads to the same equilibrium";
  EXPECT_EQ(scene.pitchfork.x[0], upper);
  EXPECT_TRUE(path.prefer_lower_from({{1.2, 1}, 1}, 1e-9));
  EXPECT_GT(scene.pitchfork.x[0], 0);
  EXPECT_EQ(path.counts().branches_left, 1);
  const double lower = scene.pitchfork.x[0];
  EXPECT_FALSE(path.prefer_lower_from({{-0.9, 1}, 1}, 1e-9));
  EXPECT_EQ(scene.pitchfork.x[0], lower);
}

TEST(EquilibriumPath, LeavesAlongAGivenModeToTheSideOfLowerEnergy) {
  for (const double tilt : {0.05, -0.05}) {
    PitchforkScene scene;
    scene.pitchfork.load = 1;
    scene.pitchfork.tilt = tilt;
    scene.pitchfork.x = {-tilt, 1};
    Path path(scene, {}, {});
    ASSERT_TRUE(path.leave_along(Eigen::Vector2d(1, 0)));
    EXPECT_GT(scene.pitchfork.x[0] * tilt, 0);
    EXPECT_FALSE(path.leave_along(Eigen::Vector2d(0, 1))) << "no step lowers the energy of an equilibrium";
  }
}

TEST(EquilibriumPath, StopsWhereItIsCancelled) {
  PitchforkScene scene;
  const CancellationToken token;
  Path path(scene, {.largest_step = 0.3}, {token});
  token.request(StopReason::cancelled);
  EXPECT_THROW(follow(scene, path), Cancelled);
}

}  // namespace
}  // namespace supple::numerics
