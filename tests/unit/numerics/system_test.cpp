#include "supple/numerics/system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <optional>

#include "supple/base/random.h"
#include "supple/numerics/minimizer.h"
#include "test_functions.h"

namespace supple::numerics {
namespace {

Eigen::MatrixXd dense(const Hessian& hessian) {
  return dense(*std::get<std::shared_ptr<const BorderedMatrix>>(hessian));
}

/// x^T A x / 2 with every entry of A, and what was asked of it.
class Quadratic : public Term<VectorState> {
 public:
  explicit Quadratic(int n) : a(n, n) {
    RandomStream random("quadratic", 1);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j <= i; ++j) a(i, j) = a(j, i) = random.uniform(-1, 1) + (i == j ? n : 0);
  }
  std::string_view name() const override { return "quadratic"; }
  bool active() const override { return is_active; }
  void prepare(VectorState& /*state*/, int order, const Execution&) override { prepared.push_back(order); }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    sum.value += 0.5 * state.x.dot(a * state.x);
    if (order >= 1) sum.gradient += a * state.x;
    if (order < 2) return;
    for (Eigen::Index i = 0; i < a.rows(); ++i)
      for (Eigen::Index j = 0; j <= i; ++j) sum.hessian.add(i, j, a(i, j));
  }
  double look_ahead(const VectorState& from, const VectorState& to, CostLedger*) override {
    looked.emplace_back(from.x, to.x);
    return allowed;
  }

  Eigen::MatrixXd a;
  bool is_active = true;
  double allowed = 1;
  std::vector<int> prepared;
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> looked;
};

TEST(Unknowns, ExpandAndRestrictAreTransposesOfEachOther) {
  Eigen::MatrixXd directions(3, 2);
  directions << 1, 0, 0, std::sqrt(0.5), 0, std::sqrt(0.5);
  const Unknowns unknowns({false, true, false, true, false}, directions);
  EXPECT_EQ(unknowns.degrees_of_freedom(), 8);
  EXPECT_EQ(unknowns.core(), 3);
  EXPECT_EQ(unknowns.size(), 5);
  const Eigen::VectorXd y = Eigen::VectorXd::LinSpaced(5, 1, 5);
  const Eigen::VectorXd x = unknowns.expand(y);
  EXPECT_EQ(x[1], 0);
  EXPECT_EQ(x[3], 0);
  EXPECT_EQ(x[4], 3);
  EXPECT_LT((unknowns.restrict(x) - y).norm(), 1e-15);
  const Eigen::VectorXd g = Eigen::VectorXd::LinSpaced(8, -2, 3);
  EXPECT_NEAR(unknowns.restrict(g).dot(y), g.dot(x), 1e-14);
  EXPECT_EQ(unknowns.expand_core(y.head(3)).col(0), x.head(5));
}

TEST(System, HasTheDerivativesByTheUnknownsOfHeldOnesAndOfABorder) {
  const auto term = std::make_shared<Quadratic>(7);
  Eigen::MatrixXd directions(2, 1);
  directions << 0.6, 0.8;
  const Unknowns unknowns({true, false, false, true, false}, directions);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(7, -1, 2);
  System<VectorState> system({x}, {term}, unknowns);
  Eigen::MatrixXd basis(7, system.dimension());
  for (Eigen::Index k = 0; k < basis.cols(); ++k) basis.col(k) = unknowns.expand(Eigen::VectorXd::Unit(4, k));
  // Twice: places are learned at the first time.
  for (int time = 0; time < 2; ++time) {
    const Evaluation at = system.evaluate(2);
    EXPECT_LT((at.gradient - basis.transpose() * term->a * x).norm(), 1e-13);
    EXPECT_LT((dense(at.hessian) - basis.transpose() * term->a * basis).norm(), 1e-13);
    EXPECT_LT((system.full_gradient() - term->a * x).norm(), 1e-13) << "reactions of held ones too";
    EXPECT_LT((system.corner() - term->a.bottomRightCorner(2, 2)).norm(), 1e-13) << "of the whole border";
    EXPECT_LT((system.border() - term->a.topRightCorner(5, 2)(std::vector{1, 2, 4}, Eigen::all)).norm(), 1e-13);
    system.set_state({x});
  }
  EXPECT_LT(check_derivatives(system).hessian.error, 1e-9);
}

/// (sum of x - 1)^2 / 2 times the weight: couples all degrees of freedom.
class KeptSum : public Term<VectorState> {
 public:
  explicit KeptSum(double weight) : weight_(weight) {}
  std::string_view name() const override { return "kept_sum"; }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    const double excess = state.x.sum() - 1;
    sum.value += 0.5 * weight_ * excess * excess;
    if (order >= 1) sum.gradient.array() += weight_ * excess;
    if (order >= 2) sum.rank_one.emplace_back(Eigen::VectorXd::Constant(state.x.size(), std::sqrt(weight_)));
  }

 private:
  double weight_;
};

TEST(System, KeepsWhatCouplesAllDegreesOfFreedomApartFromTheSparseMatrix) {
  const auto term = std::make_shared<Quadratic>(7);
  Eigen::MatrixXd directions(2, 1);
  directions << 0.6, 0.8;
  const Unknowns unknowns({true, false, false, true, false}, directions);
  System<VectorState> system({Eigen::VectorXd::LinSpaced(7, -1, 2)}, {term, std::make_shared<KeptSum>(1e3)}, unknowns);
  const auto matrix = std::get<std::shared_ptr<const BorderedMatrix>>(system.evaluate(2).hessian);
  EXPECT_EQ(matrix->low_rank.cols(), 1);
  EXPECT_LT(matrix->core.coeff(1, 0), 7) << "the sparse part is without it";
  EXPECT_LT(check_derivatives(system).hessian.error, 1e-9);
  const MinimizerResult found = minimize(system);
  EXPECT_EQ(found.stop, MinimizerTermination::converged);
  EXPECT_EQ(found.iterations, 1) << "a quadratic function";
}

/// -x^2 / 2 of each unknown, or nothing where convex matrices are asked for.
class Hill : public Term<VectorState> {
 public:
  std::string_view name() const override { return "hill"; }
  bool has_convex_hessian() const override { return true; }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    sum.value -= state.x.squaredNorm() / 2;
    if (order >= 1) sum.gradient -= state.x;
    for (Eigen::Index i = 0; i < state.x.size() && order >= 2; ++i) sum.hessian.add(i, i, sum.convex ? 0 : -1);
  }
};

TEST(System, HasAConvexMatrixBesideItsHessianWhereATermHasOne) {
  const auto quadratic = std::make_shared<Quadratic>(3);
  System<VectorState> plain({Eigen::Vector3d(1, 2, 3)}, {quadratic}, Unknowns(3));
  plain.evaluate(2);
  EXPECT_FALSE(plain.convex_hessian()) << "no term has one";
  System<VectorState> system({Eigen::Vector3d(1, 2, 3)}, {quadratic, std::make_shared<Hill>()}, Unknowns(3));
  EXPECT_FALSE(system.convex_hessian()) << "its Hessian was not evaluated";
  const Evaluation before = system.evaluate(2);
  const Eigen::MatrixXd exact = dense(before.hessian);
  EXPECT_LT((exact - quadratic->a + Eigen::Matrix3d::Identity()).norm(), 1e-14);
  const std::optional<Hessian> convex = system.convex_hessian();
  ASSERT_TRUE(convex);
  EXPECT_LT((dense(*convex) - quadratic->a).norm(), 1e-14);
  EXPECT_EQ(dense(before.hessian), exact) << "what was evaluated stays";
  const Evaluation after = system.evaluate(2);
  EXPECT_EQ(dense(after.hessian), exact) << "and is the Hessian again";
  EXPECT_EQ(after.gradient, before.gradient);
  EXPECT_EQ(after.value, before.value);
}

TEST(System, LeavesHeldDegreesOfFreedomWhereTheyAre) {
  const auto term = std::make_shared<Quadratic>(4);
  System<VectorState> system({Eigen::Vector4d(1, 2, 3, 4)}, {term}, Unknowns(std::vector{true, false, false, true}));
  const MinimizerResult result = minimize(system);
  EXPECT_EQ(result.stop, MinimizerTermination::converged);
  EXPECT_EQ(system.state().x[0], 1);
  EXPECT_EQ(system.state().x[3], 4);
  EXPECT_LT(system.full_gradient().segment(1, 2).norm(), 1e-9);
  EXPECT_GT(std::abs(system.full_gradient()[0]), 0.1);
}

TEST(System, EvaluatesAStateOnceForEachOrderThatRises) {
  const auto term = std::make_shared<Quadratic>(3);
  System<VectorState> system({Eigen::Vector3d(1, 2, 3)}, {term}, Unknowns(3), {.min_order = 1});
  system.evaluate(0);
  system.evaluate(1);
  EXPECT_EQ(term->prepared, (std::vector{1})) << "the gradient comes with the value";
  system.evaluate(2);
  system.evaluate(2);
  EXPECT_EQ(term->prepared, (std::vector{1, 2}));
  system.move(Eigen::Vector3d::Ones());
  const double moved = system.evaluate(0).value;
  EXPECT_NEAR(moved, 0.5 * Eigen::Vector3d(2, 3, 4).dot(term->a * Eigen::Vector3d(2, 3, 4)), 1e-12);
  system.accept();
  EXPECT_EQ(system.evaluate(1).value, moved);
  EXPECT_EQ(term->prepared, (std::vector{1, 2, 1})) << "what was evaluated on trial holds once it is accepted";
  system.move(Eigen::Vector3d::Ones());
  system.evaluate(0);
  system.reject();
  EXPECT_EQ(system.evaluate(0).value, moved);
  system.forget();
  system.evaluate(0);
  EXPECT_EQ(term->prepared, (std::vector{1, 2, 1, 1, 1, 1}));
}

TEST(System, GoesAsFarAsEveryTermThatLooksAheadAllows) {
  const auto first = std::make_shared<Quadratic>(2);
  const auto second = std::make_shared<Quadratic>(2);
  first->allowed = 0.5;
  second->allowed = 0.4;
  System<VectorState> system({Eigen::Vector2d(1, 1)}, {first, second}, Unknowns(2));
  const Eigen::VectorXd travelled = system.move(Eigen::Vector2d(10, 20));
  EXPECT_LT((travelled - Eigen::Vector2d(2, 4)).norm(), 1e-14);
  EXPECT_EQ(second->looked.back().second, Eigen::VectorXd(Eigen::Vector2d(6, 11))) << "what the first one left";
  system.accept();
  EXPECT_LT((system.state().x - Eigen::Vector2d(3, 5)).norm(), 1e-14);
  EXPECT_EQ(system.look_ahead({Eigen::Vector2d(0, 0)}, {Eigen::Vector2d(1, 0)}), 0.2);
}

TEST(System, LeavesTermsOutThatAreNotActiveAndBillsTheOthers) {
  CostLedger cost;
  const auto on = std::make_shared<Quadratic>(2);
  const auto off = std::make_shared<Quadratic>(2);
  off->is_active = false;
  System<VectorState> system({Eigen::Vector2d(1, 1)}, {off}, Unknowns(2), {.execution = {.cost = &cost}});
  EXPECT_EQ(system.evaluate(0).value, 0);
  EXPECT_TRUE(cost.effects().empty());
  System<VectorState> both({Eigen::Vector2d(1, 1)}, {off, on}, Unknowns(2), {.execution = {.cost = &cost}});
  EXPECT_GT(both.evaluate(2).value, 0);
  ASSERT_EQ(cost.effects().size(), 1U);
  EXPECT_EQ(cost.effects()[0].name, "quadratic");
  EXPECT_EQ(cost.effects()[0].count, 1);
}

/// A place on a circle, with a frame that is taken where derivatives are asked for.
struct CircleState {
  double angle = 0;
  double frame = 0;  ///< angle at which it was taken
  bool carries = true;
  static constexpr std::string_view motion = "walk";
  Eigen::Index dimension() const { return 1; }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    angle += step[0];
    return step;
  }
  void take_frame() { frame = angle; }
  bool transport(Eigen::VectorXd& tangent) const {
    tangent *= -1;
    return carries;
  }
};

/// |angle - 1|.
class Bend : public Term<CircleState> {
 public:
  std::string_view name() const override { return "bend"; }
  void add(const CircleState& state, int order, EnergySum& sum) const override {
    if (order >= 1) {
      EXPECT_EQ(state.frame, state.angle) << "derivatives in a stale frame";
      sum.gradient[0] += state.angle > 1 ? 1 : -1;
    }
    sum.value += std::abs(state.angle - 1);
  }
};

/// Three places, of which one is the minimum of |angle - 1|.
class ThreePlaces : public NonsmoothSearch<CircleState> {
 public:
  std::vector<NonsmoothCandidate<CircleState>> candidates(const CircleState& current,
                                                          const std::vector<CircleState>& trials,
                                                          double reach) const override {
    trial_count = trials.size();
    for (const CircleState& state : trials) trial_angles.push_back(state.angle);
    last_reach = reach;
    std::vector<NonsmoothCandidate<CircleState>> candidates;
    for (const double at : {0.3, 1.0, 5.0})
      candidates.push_back({{at, 0, true}, std::lround(10 * at), std::abs(at - current.angle), false});
    return candidates;
  }
  mutable std::size_t trial_count = 0;
  mutable std::vector<double> trial_angles;
  mutable double last_reach = 0;
};

TEST(System, TakesTheFrameOfAStateBeforeItsDerivatives) {
  CostLedger cost;
  System<CircleState> system({0.25, 0, true}, {std::make_shared<Bend>()}, Unknowns(1), {.execution = {.cost = &cost}});
  system.evaluate(1);
  system.move(Eigen::VectorXd::Constant(1, 0.5));
  system.evaluate(0);
  EXPECT_EQ(system.evaluate(1).gradient[0], -1);
  Eigen::VectorXd tangent = Eigen::VectorXd::Constant(1, 3);
  EXPECT_TRUE(system.transport(tangent));
  EXPECT_EQ(tangent[0], -3);
  system.accept();
  EXPECT_EQ(system.state().frame, 0.75);
  ASSERT_EQ(cost.stages().size(), 1U);
  EXPECT_EQ(cost.stages()[0].name, "walk");
  System<CircleState> kinked({0.25, 0, false}, {std::make_shared<Bend>()}, Unknowns(1));
  EXPECT_FALSE(kinked.transport(tangent));
}

TEST(System, MovesAStateThatCannotGoBackAgainByLess) {
  class Half : public Bend {
   public:
    double look_ahead(const CircleState&, const CircleState&, CostLedger*) override { return 0.5; }
  };
  System<CircleState> system({0.25, 0, true}, {std::make_shared<Half>()}, Unknowns(1));
  EXPECT_EQ(system.move(Eigen::VectorXd::Constant(1, 0.5))[0], 0.25);
  system.accept();
  EXPECT_EQ(system.state().angle, 0.5);
}

TEST(System, TakesTheLowestCandidateOfItsSearchAndTriesEachOnce) {
  const auto search = std::make_shared<ThreePlaces>();
  System<CircleState> system({0, 0, true}, {std::make_shared<Bend>()}, Unknowns(1), {}, search);
  system.evaluate(1);
  system.move(Eigen::VectorXd::Constant(1, 0.5));
  system.evaluate(0);
  system.reject();
  system.move(Eigen::VectorXd::Constant(1, 0.2));
  system.evaluate(0);
  const std::optional<double> distance = system.try_nonsmooth_candidates();
  ASSERT_TRUE(distance);
  EXPECT_EQ(*distance, 1);
  EXPECT_EQ(search->trial_count, 2U);
  EXPECT_EQ(search->last_reach, 0.5);
  EXPECT_EQ(search->trial_angles, (std::vector<double>{0.5, 0.2})) << "in the order of the trials";
  EXPECT_EQ(system.evaluate(0).value, 0);
  system.reject();
  EXPECT_FALSE(system.try_nonsmooth_candidates()) << "all of them were tried from this state";
  EXPECT_EQ(system.evaluate(0).value, 1) << "the current state is as it was";
  system.move(Eigen::VectorXd::Constant(1, 0.2));
  system.accept();
  EXPECT_TRUE(system.try_nonsmooth_candidates()) << "from another state they may be tried again";
  EXPECT_EQ(search->trial_count, 0U);
}

TEST(System, TriesNoCandidatesWithoutASearch) {
  System<CircleState> system({0, 0, true}, {std::make_shared<Bend>()}, Unknowns(1));
  system.evaluate(1);
  EXPECT_FALSE(system.try_nonsmooth_candidates());
  EXPECT_EQ(system.evaluate(0).value, 1);
}

TEST(System, TakesNoCandidateThatLiesHigherUnlessItIsTheSamePlace) {
  class Here : public NonsmoothSearch<CircleState> {
   public:
    explicit Here(bool same) : same_(same) {}
    std::vector<NonsmoothCandidate<CircleState>> candidates(const CircleState&, const std::vector<CircleState>&,
                                                            double) const override {
      return {{{0.5 - 1e-15, 0, true}, 1, 1e-15, same_}};
    }

   private:
    bool same_;
  };
  for (const bool same : {false, true}) {
    System<CircleState> system({0.5, 0, true}, {std::make_shared<Bend>()}, Unknowns(1), {},
                               std::make_shared<Here>(same));
    system.evaluate(1);
    EXPECT_EQ(system.try_nonsmooth_candidates().has_value(), same);
  }
}

TEST(System, GoesOnWithTheSumsOfAnotherOneOfTheSameTerms) {
  const auto sums = std::make_shared<EnergySum>();
  sums->hessian = HessianEntries(Unknowns(4).numbering());
  const auto term = std::make_shared<Quadratic>(4);
  for (const double scale : {1.0, 2.0}) {
    System<VectorState> system({scale * Eigen::Vector4d(1, 2, 3, 4)}, {term}, Unknowns(4), {.sums = sums});
    const Evaluation at = system.evaluate(2);
    EXPECT_LT((at.gradient - scale * term->a * Eigen::Vector4d(1, 2, 3, 4)).norm(), 1e-13);
    EXPECT_LT((dense(at.hessian) - term->a).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace supple::numerics
