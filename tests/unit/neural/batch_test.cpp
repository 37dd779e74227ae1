#include "supple/neural/batch.h"

#include <gtest/gtest.h>

#include <vector>

#include "supple/base/cost_ledger.h"
#include "support/expect_error.h"
#include "support/test_model.h"

namespace supple::neural {
namespace {

using testing::places;

class Batches : public ::testing::Test {
 protected:
  static Eigen::Matrix3Xd strains_of(Eigen::Index count) {
    Eigen::Matrix3Xd strains(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / 1000;
      strains.col(i) << 0.02 + t / 20, -0.01, 0.005 * t;
    }
    return strains;
  }
  BatchResult run(const std::vector<std::vector<double>>& designs, const Eigen::Matrix3Xd& strains, Order order,
                  CostLedger* cost = nullptr) const {
    return evaluate_batch(model, evaluator, {designs, strains, order}, {.cost = cost});
  }

  Model model = test::test_model("one", 1);
  Evaluator evaluator{model.network};
};

TEST_F(Batches, OfOneDesignAreWhatTheEvaluatorSays) {
  const auto strains = strains_of(700);
  const std::vector<double> parameters{0.15, 0.65};
  const auto design = evaluator.design(parameters);
  for (const Order order : {Order::energy, Order::stress, Order::tangent}) {
    const auto result = run({parameters}, strains, order);
    Evaluator::Workspace workspace;
    Evaluation expected;
    for (const Eigen::Index i : {0, 47, 48, 192, 500, 699}) {
      evaluator.evaluate(design, strains.middleCols(i, 1), order, workspace, expected);
      EXPECT_NEAR(result.values.energy_density[i], expected.energy_density[0], 1e-13);
      EXPECT_TRUE(order < Order::stress || (result.values.stress.col(i) - expected.stress.col(0)).norm() < 1e-12);
      EXPECT_TRUE(order < Order::tangent || (result.values.tangent.col(i) - expected.tangent.col(0)).norm() < 1e-11);
    }
    EXPECT_EQ(result.values.stress.cols(), order >= Order::stress ? 700 : 0);
    EXPECT_EQ(result.values.tangent.cols(), order >= Order::tangent ? 700 : 0);
  }
}

TEST_F(Batches, PrepareEqualDesignsThatFollowOneAnotherOnce) {
  const auto strains = strains_of(600);
  std::vector<std::vector<double>> designs(600, {0.12, 0.55});
  for (std::size_t i = 200; i < 350; ++i) designs[i] = {0.18, 0.7};
  CostLedger bill;
  const auto result = run(designs, strains, Order::stress, &bill);
  ASSERT_EQ(bill.quantities().size(), 2U);
  EXPECT_EQ(bill.quantities()[0].value, 3) << "stretches of equal designs";
  EXPECT_EQ(bill.quantities()[1].value, 600);
  for (const std::size_t i : {0U, 199U, 200U, 349U, 350U, 599U}) {
    const auto alone = run({designs[i]}, strains.middleCols(static_cast<Eigen::Index>(i), 1), Order::stress);
    EXPECT_LT((result.values.stress.col(static_cast<Eigen::Index>(i)) - alone.values.stress.col(0)).norm(), 1e-13);
    EXPECT_EQ(result.trust[i].in_range, alone.trust[0].in_range);
  }
}

TEST_F(Batches, SayWhatLiesWithinTheTrainingAtEveryOrder) {
  Eigen::Matrix3Xd strains(3, 2);
  strains << 0.001, 0.35, 0, 0, 0, 0;
  for (const Order order : {Order::energy, Order::stress}) {
    const auto result = run({{0.15, 0.65}}, strains, order);
    EXPECT_TRUE(result.trust[0].in_range);
    EXPECT_FALSE(result.trust[1].in_range);
    EXPECT_FALSE(run({{0.3, 0.65}}, strains, order).trust[0].in_range);
  }
}

TEST_F(Batches, AreCheckedAgainstTheModel) {
  const auto strains = strains_of(3);
  const std::vector<std::vector<double>> wrong{{0.1, 0.5}, {0.1}, {0.1, 0.2, 0.3}};
  const std::vector<std::vector<double>> two{{0.1, 0.5}, {0.1, 0.5}};
  const std::vector<std::vector<double>> good{{0.1, 0.5}};
  EXPECT_NO_THROW(check_batch(model, {good, strains}));
  EXPECT_EQ(places(testing::expect_error("model.parameter_count",
                                         [&] {
                                           check_batch(model, {wrong, strains});
                                         })),
            (std::vector<std::string>{"parameters/1", "parameters/2"}));
  EXPECT_EQ(places(testing::expect_error("model.parameter_count",
                                         [&] {
                                           check_designs(model, {&wrong[1], 1}, "parameters", false);
                                         })),
            std::vector<std::string>{"parameters"});
  testing::expect_error("model.design_count", [&] { check_batch(model, {two, strains}); });
  const std::vector<std::vector<double>> many(50, {0.1});
  EXPECT_EQ(
      places(testing::expect_error("model.parameter_count", [&] { check_designs(model, many, "parameters", true); }))
          .size(),
      20U);
}

TEST_F(Batches, WithoutAFiniteValueNameTheStrain) {
  const auto huge = test::test_model("huge", 1, 1e160);
  const Evaluator overflowing(huge.network);
  Eigen::Matrix3Xd strains = Eigen::Matrix3Xd::Zero(3, 3);
  strains(0, 2) = 0.02;
  const std::vector<std::vector<double>> designs{{0.15, 0.65}};
  const auto place = [&](Order order) {
    return places(testing::expect_error("model.not_finite",
                                        [&] {
                                          evaluate_batch(huge, overflowing, {designs, strains, order});
                                        }))
        .at(0);
  };
  EXPECT_EQ(place(Order::energy), "green_strain/2") << "energy and stress at rest are 0, whatever the weights";
  EXPECT_EQ(place(Order::stress), "green_strain/2");
  EXPECT_EQ(place(Order::tangent), "green_strain/0") << "the stiffness at rest overflows";
}

TEST_F(Batches, StopWhereTheyAreAskedTo) {
  CancellationToken token;
  token.request(StopReason::cancelled);
  const std::vector<std::vector<double>> designs{{0.15, 0.65}};
  testing::expect_cancelled(StopReason::cancelled, [&] {
    evaluate_batch(model, evaluator, {designs, strains_of(10)}, {.cancellation = token});
  });
}

TEST(BestOfFamilies, AreThoseThatErrLeastOnDesignsNotSeen) {
  std::vector<Model> models;
  for (const auto& [family, error] : {std::pair("IH01", 2.0), std::pair("IH21", -1.0), std::pair("IH01", 1.0),
                                      std::pair("IH21", 3.0), std::pair("IH01", -1.0), std::pair("IH22", -1.0)}) {
    auto& model = models.emplace_back(test::test_model("m", 1));
    model.family = family;
    if (error < 0) {
      model.design_split.reset();
    } else {
      model.design_split->gradient.mean = error;
    }
  }
  std::vector<const Model*> pointers;
  for (const Model& model : models) pointers.push_back(&model);
  EXPECT_EQ(best_of_families(pointers), (std::vector<std::size_t>{2, 3, 5}));
  EXPECT_TRUE(best_of_families({}).empty());
  models[0].definition = "another family of this name";
  EXPECT_EQ(best_of_families(pointers), (std::vector<std::size_t>{0, 3, 2, 5}))
      << "in the order in which the families first occur";
}

}  // namespace
}  // namespace supple::neural
