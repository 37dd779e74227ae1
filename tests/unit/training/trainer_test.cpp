#include "supple/training/trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sample_data.h"
#include "supple/neural/evaluator.h"
#include "supple/training/model_errors.h"
#include "support/expect_error.h"
#include "support/law_samples.h"
#include "support/temporary_folder.h"

namespace supple::training {
namespace {

TrainingOptions small_options(int epochs) {
  TrainingOptions options;
  options.shape.width = 32;
  options.shape.parameters = 1;
  options.shape.stiffness_width = 16;
  options.epochs = epochs;
  options.max_input_scale = 4;
  options.validation_interval = 2;
  return options;
}

const Samples& samples() {
  static const Samples made = law_samples(40, 20, 1);
  return made;
}
const Split& parts() {
  static const Split made = split(samples(), {.validation = 0.1, .test = 0.2, .row_test = 0.05, .seed = 1});
  return made;
}

bool same(const neural::Network& a, const neural::Network& b) {
  for (const auto branch :
       {&neural::Network::strain, &neural::Network::parameter, &neural::Network::trunk, &neural::Network::stiffness})
    for (std::size_t i = 0; i < (a.*branch).size(); ++i)
      if ((a.*branch)[i].weights != (b.*branch)[i].weights || (a.*branch)[i].bias != (b.*branch)[i].bias) return false;
  return true;
}

void ignore(const EpochReport&) {}

TEST(Split, NoDesignIsInTwoPartsAndSomeOnlyTrain) {
  auto all = samples();
  for (auto& design : all.designs) design.trains_only = design.index % 5 == 0;
  const auto made = split(all);
  const auto design_of = [&](int row) { return row / 20; };
  std::vector<int> owner(40, 0);
  const auto mark = [&](const std::vector<int>& rows, int part) {
    for (const int row : rows) {
      auto& o = owner[static_cast<std::size_t>(design_of(row))];
      EXPECT_TRUE(o == 0 || o == part) << "design " << design_of(row) << " is in two parts";
      o = part;
    }
  };
  mark(made.training, 1);
  mark(made.validation, 2);
  mark(made.test, 3);
  for (const int row : made.row_test) EXPECT_EQ(owner[static_cast<std::size_t>(design_of(row))], 1);
  for (const auto* part : {&made.validation, &made.test, &made.row_test})
    for (const int row : *part) EXPECT_NE(design_of(row) % 5, 0) << "a design that only trains was judged by";
  const auto total = made.training.size() + made.validation.size() + made.test.size() + made.row_test.size();
  EXPECT_EQ(total, 800U);
  EXPECT_EQ(made.test.size(), 4U * 20U);  // 12 % of 32 designs
}

TEST(Training, LearnsALawOnDesignsItHasNotSeen) {
  std::vector<EpochReport> reports;
  const auto result =
      train(samples(), parts(), small_options(120), {}, {}, [&](const auto& r) { reports.push_back(r); });
  ASSERT_TRUE(result.finished);
  EXPECT_EQ(reports.size(), 120U);
  EXPECT_LT(reports.back().loss, 0.2 * reports.front().loss);
  const auto errors = split_errors(result.network, samples(), parts().test);
  EXPECT_EQ(errors.designs, 8);
  EXPECT_LT(errors.gradient.mean, 0.02);
  EXPECT_LT(errors.energy.mean, 0.01);
  EXPECT_LE(errors.gradient.median, errors.gradient.percentile_99);
}

TEST(Training, TheSameSeedGivesTheSameBitsAndAnotherOthers) {
  auto options = small_options(4);
  const auto one = train(samples(), parts(), options, {}, {}, ignore);
  const auto two = train(samples(), parts(), options, {}, {}, ignore);
  EXPECT_TRUE(same(one.network, two.network));
  options.seed = 2;
  EXPECT_FALSE(same(one.network, train(samples(), parts(), options, {}, {}, ignore).network));
}

TEST(Training, BeginsWithAnotherOnesNetwork) {
  const auto first = train(samples(), parts(), small_options(30), {}, {}, ignore);
  auto options = small_options(30);
  options.start = first.network;
  options.learning_rate = 2e-3;
  options.tangent_begin = 0;
  const auto on = train(samples(), parts(), options, {}, {}, ignore);
  EXPECT_LT(on.history.front().loss, 2 * first.history.back().loss) << "where the first one ended";
  EXPECT_LT(split_errors(on.network, samples(), parts().test).gradient.mean,
            split_errors(first.network, samples(), parts().test).gradient.mean);
  options.shape.trunk_layers = 4;
  const auto error = testing::expect_error("training.invalid_option",
                                           [&] { (void)train(samples(), parts(), options, {}, {}, ignore); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"start"});
}

TEST(Training, AnInterruptedOneGoesOnWithTheSameBits) {
  const testing::TemporaryFolder folder;
  const auto checkpoint = folder / "training.partial";
  const auto options = small_options(8);
  const CancellationToken stop;
  const auto part = train(samples(), parts(), options, checkpoint, stop, [&](const EpochReport& r) {
    if (r.epoch == 5) stop.request(StopReason::cancelled);
  });
  EXPECT_FALSE(part.finished);
  EXPECT_EQ(part.history.size(), 5U);
  const auto rest = train(samples(), parts(), options, checkpoint, {}, ignore);
  EXPECT_TRUE(rest.finished);
  EXPECT_EQ(rest.history.size(), 8U);
  EXPECT_TRUE(same(rest.network, train(samples(), parts(), options, {}, {}, ignore).network));
}

TEST(Training, ACheckpointOfOtherOptionsIsRefusedByName) {
  const testing::TemporaryFolder folder;
  const auto checkpoint = folder / "training.partial";
  const CancellationToken stop;
  (void)train(samples(), parts(), small_options(8), checkpoint, stop,
              [&](const EpochReport&) { stop.request(StopReason::cancelled); });
  auto other = small_options(8);
  other.learning_rate = 1e-3;
  const auto error = testing::expect_error("training.different_options",
                                           [&] { (void)train(samples(), parts(), other, checkpoint, {}, ignore); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"learning_rate"});
}

TEST(Training, EndsEarlyWhereValidationNoLongerFalls) {
  auto options = small_options(400);
  options.learning_rate = options.final_learning_rate = 1e-12;
  options.patience = 6;
  const auto result = train(samples(), parts(), options, {}, {}, ignore);
  EXPECT_TRUE(result.finished);
  EXPECT_LT(result.history.size(), 40U);
}

TEST(Training, OptionsOutOfRangeAreNamed) {
  auto options = small_options(1);
  options.shape.width = 40;
  const auto error = testing::expect_error("training.invalid_option",
                                           [&] { (void)train(samples(), parts(), options, {}, {}, ignore); });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"width"});
}

TEST(Training, TheSquaredLossLearnsTooAndIsAnotherTraining) {
  auto options = small_options(60);
  options.loss = LossKind::squared;
  const auto result = train(samples(), parts(), options, {}, {}, ignore);
  EXPECT_LT(result.history.back().loss, 0.02 * result.history.front().loss) << "squares of errors";
  EXPECT_LT(split_errors(result.network, samples(), parts().test).gradient.mean, 0.03);
  const auto loss_named = [](const TrainingOptions& of) {
    for (const auto& [name, value] : describe(of))
      if (name == "loss") return value;
    return std::string();
  };
  EXPECT_EQ(loss_named(options), "squared");
  EXPECT_EQ(loss_named(small_options(1)), "robust");
  EXPECT_EQ(loss_of("squared"), LossKind::squared);
  testing::expect_error("training.invalid_option", [] { (void)loss_of("relative"); });
  EXPECT_EQ(device_of("cuda"), DeviceKind::cuda);
  testing::expect_error("training.invalid_option", [] { (void)device_of("gpu"); });
}

TEST(ModelErrors, AreThoseOfTheRowsThatCount) {
  const auto result = train(samples(), parts(), small_options(2), {}, {}, ignore);
  // The data are made so that the network's energies, stresses and tangents are too large by one, two and three per
  // cent.
  auto made = samples();
  const neural::Evaluator evaluator(result.network);
  for (const auto& design : made.designs) {
    const auto answer = evaluator.evaluate(evaluator.design(design.parameters),
                                           made.strain.middleCols(design.first, design.count), neural::Order::tangent);
    made.energy.segment(design.first, design.count) = answer.energy_density / 1.01;
    made.stress.middleCols(design.first, design.count) = answer.stress / 1.02;
    made.tangent.middleCols(design.first, design.count) = answer.tangent / 1.03;
  }
  made.energy[3] = 0.5 * min_evaluated_energy;
  const auto errors = row_errors(result.network, made, {0, 3, 25, 700});
  EXPECT_EQ(errors.rows, (std::vector{0, 25, 700}));
  for (long i = 0; i < 3; ++i) {
    EXPECT_NEAR(errors.energy[i], 0.01, 1e-12);
    EXPECT_NEAR(errors.gradient[i], 0.02, 1e-12);
    EXPECT_NEAR(errors.stiffness[i], 0.03, 1e-9);
  }
  const auto range = strain_range(result.network, samples(), parts().training);
  EXPECT_LT(range.smallest_principal, -0.15);
  EXPECT_GT(range.largest_principal, 0.3);
}

}  // namespace
}  // namespace supple::training
