#include "supple/training/model_training.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "sample_data.h"
#include "supple/microscale/simulation.h"
#include "supple/neural/evaluator.h"
#include "supple/tiling/definition_text.h"
#include "supple/tiling/structure.h"
#include "support/expect_error.h"
#include "support/random_network.h"

namespace supple::training {
namespace {

/// The simulated tangent stiffness of an undeformed structure, MPa.
Eigen::Matrix3d rest_stiffness(const tiling::Family& family, const Eigen::VectorXd& p) {
  microscale::SimulationOptions options;
  options.mesh.mesh_size = 0.5;
  microscale::Simulator simulator(tiling::make_structure(family, std::vector<double>(p.data(), p.data() + p.size())),
                                  options);
  const auto result = simulator.run(microscale::GreenStrainLoad{{Eigen::Vector3d::Zero()}});
  return result.states.at(0).tangent;
}

TEST(EnergySymmetries, HoldForSimulatedStiffness) {
  for (const char* id : {"IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67"}) {
    const auto& family = tiling::family(id);
    Eigen::VectorXd p(static_cast<long>(family.parameters.size()));
    for (long k = 0; k < p.size(); ++k) {
      const auto& [lower, upper, preset] = family.parameters[static_cast<std::size_t>(k)];
      p[k] = lower + (k == 1 ? 0.62 : 0.45) * (upper - lower);
    }
    const Eigen::Matrix3d stiffness = rest_stiffness(family, p);
    for (const auto& [strain, linear, constant] : energy_symmetries(family)) {
      const Eigen::VectorXd image = linear * p + constant;
      const Eigen::Matrix3d other = (image - p).norm() < 1e-9 ? stiffness : rest_stiffness(family, image);
      EXPECT_LT((strain.transpose() * other * strain - stiffness).norm(), 0.01 * stiffness.norm()) << id << "\n"
                                                                                                   << strain;
    }
  }
}

TEST(EnergySymmetries, AreAsManyAsTheFamilysDistinctOrientations) {
  const auto count = [](const char* id) { return energy_symmetries(tiling::family(id)).size(); };
  EXPECT_EQ(count("IH01"), 1U) << "the mirror image";
  EXPECT_EQ(count("IH21"), 2U) << "sixfold rotation: three orientations of a strain";
  EXPECT_EQ(count("IH22"), 3U) << "a mirror, and the same under another name";
  EXPECT_EQ(count("IH28"), 3U) << "a quarter turn, and the mirror image";
  EXPECT_EQ(count("IH29"), 3U) << "a quarter turn and mirrors";
  EXPECT_EQ(count("IH50"), 3U) << "a mirror, and the same under another name";
  EXPECT_EQ(count("IH67"), 1U) << "a mirror of each tile";
}

/// Designs with invented rows, as many as a split needs.
dataset::Dataset drawn_data(int designs) {
  dataset::Dataset data;
  data.recipe.set("lower_bounds", std::vector<double>{-1, -1});
  data.recipe.set("upper_bounds", std::vector<double>{1, 1});
  for (int i = 0; i < designs; ++i) data.designs.push_back(dataset::sample_design(i));
  return data;
}

TEST(SamplesOfAModel, OfOtherDataThanItsOwnAreRefused) {
  const ModelData data{drawn_data(60), {}};
  neural::Model model;
  model.provenance.options = describe(ModelOptions{});
  model.provenance.rows = static_cast<std::int64_t>(split(read_samples(data)).training.size());
  EXPECT_FALSE(samples_of(model, data).split.test.empty());
  testing::expect_error("training.different_data", [&] { (void)samples_of(model, {drawn_data(80), {}}); });
}

TEST(Symmetrized, AModelHasTheRotationsOfItsFamilyAndErrorsMeasuredAnew) {
  const ModelData data{drawn_data(60), {}};
  neural::Model model;
  model.family = "IH21";
  neural::NetworkShape shape;
  shape.width = 16;
  shape.parameters = 2;
  model.network = neural::random_network(shape, 1);
  model.provenance.options = describe(ModelOptions{});
  model.provenance.rows = static_cast<std::int64_t>(split(read_samples(data)).training.size());
  const auto made = symmetrized(model, data);
  EXPECT_EQ(made.network.symmetries.size(), 2U) << "a sixth and a third of a turn";
  EXPECT_GT(made.design_split->designs, 0);
  EXPECT_GT(made.strain_range.largest_principal, made.strain_range.smallest_principal);
  model.family = "IH01";
  testing::expect_error("training.no_symmetry", [&] { (void)symmetrized(model, data); });
}

TEST(Narrowed, AModelEndsWhereItsDataEndAndHasTheSameValues) {
  ModelData data{drawn_data(60), {}};
  data.data.designs[0].parameters = {0.97, -1};
  data.data.designs[1].parameters = {0.5, 0.98};
  // Structures whose first parameter is small have no rows, as if they could not be simulated.
  double least = 1;
  for (auto& design : data.data.designs) {
    if (design.parameters[0] < -0.5) design.rows.clear();
    if (!design.rows.empty()) least = std::min(least, design.parameters[0]);
  }
  neural::Model model;
  neural::NetworkShape shape;
  shape.parameters = 2;
  shape.width = 16;
  model.network = neural::random_network(shape, 3);
  model.network.lower.setConstant(-1);
  model.network.upper.setConstant(1);
  model.network.mesh_correction.resize(6, 6);
  for (long i = 0; i < 36; ++i) model.network.mesh_correction.data()[i] = 0.01 * static_cast<double>(i % 11 - 5);
  model.provenance.options = describe(ModelOptions{});
  model.provenance.rows = static_cast<std::int64_t>(split(read_samples(data)).training.size());
  const neural::Model made = narrowed(model, data);
  EXPECT_EQ(made.network.lower[0], least);
  EXPECT_EQ(made.network.upper[0], 1);
  EXPECT_EQ(made.network.lower[1], -1) << "data that end within 2 % of the width cover a bound";
  const std::vector<double> parameters{0.3, -0.2};
  const Eigen::Vector3d strain(0.05, -0.02, 0.03);
  const neural::Evaluator before(model.network), after(made.network);
  const auto energy = [&](const neural::Evaluator& evaluator) {
    return evaluator.evaluate(evaluator.design(parameters), strain, neural::Order::energy).energy_density[0];
  };
  EXPECT_NEAR(energy(after), energy(before), 1e-12 * std::abs(energy(before)));
}

TEST(TrainModel, GoesOnWithAModelOfTheSameDataAndSplit) {
  ModelData data{drawn_data(60), {}};
  data.data.recipe.set("family", std::string("IH28"));
  data.data.recipe.set("youngs_modulus", 10.0);
  data.data.recipe.set("poisson_ratio", 0.4);
  ModelOptions options;
  options.use_symmetry = false;
  options.training.shape.width = 16;
  options.training.epochs = 20;
  const auto train = [&](const ModelOptions& with) {
    return train_model(data, "drawn", "test", with, {}, {}, [](auto&) {});
  };
  const auto first = train(options);
  auto on = options;
  on.start = first.model;
  on.training.shape.width = 256;
  on.training.learning_rate = 1e-3;
  on.training.epochs = 10;
  const auto second = train(on);
  EXPECT_EQ(second.model.network.shape.width, 16) << "the start's shape holds";
  EXPECT_GT(second.model.provenance.training_seconds, first.model.provenance.training_seconds);
  EXPECT_TRUE(
      std::ranges::count(second.model.provenance.options, std::pair<std::string, std::string>("start_epochs", "20")));

  on.start = second.model;
  on.training.epochs = 2;
  const auto third = train(on).model.provenance.options;
  EXPECT_TRUE(std::ranges::count(third, std::pair<std::string, std::string>("start_epochs", "30"))) << "of both before";

  on.split.seed = 2;
  testing::expect_error("training.different_data", [&] { (void)train(on); });
  on = options;
  on.start = first.model;
  on.start->family = "IH50";
  testing::expect_error("training.different_data", [&] { (void)train(on); });
}

TEST(TrainModel, KeepsTheDefinitionOfAFamilyOfOnesOwn) {
  ModelData data{drawn_data(60), {}};
  auto definition = *tiling::family("IH28").definition;
  definition.id = "Own_1";
  definition.beam_width = {0.1, 0.01};
  data.data.recipe.set("family", definition.id);
  data.data.recipe.set("definition", tiling::to_text(definition));
  data.data.recipe.set("youngs_modulus", 10.0);
  data.data.recipe.set("poisson_ratio", 0.4);
  ModelOptions options;
  options.use_features = true;
  options.training.shape.width = 16;
  options.training.epochs = 2;
  const auto train = [&](const ModelOptions& with) {
    return train_model(data, "drawn", "test", with, {}, {}, [](auto&) {}).model;
  };
  const auto model = train(options);
  EXPECT_EQ(model.id, "own-1");
  EXPECT_EQ(model.family, "Own_1");
  EXPECT_EQ(tiling::definition_of_text(model.definition), definition);
  EXPECT_EQ(model.network.geometry.beam_width_slopes, (std::vector<double>{0.01, 0}));

  // A start of a family that has the same id and is another one is refused.
  options.start = model;
  definition.beam_width = {0.1, 0.02};
  options.start->definition = tiling::to_text(definition);
  testing::expect_error("training.different_data", [&] { (void)train(options); });
}

TEST(ReadSamples, FurtherDataTrainAndLeaveTheHeldOutDesignsAsTheyAre) {
  const ModelData alone{drawn_data(60), {}};
  auto further = drawn_data(25);
  further.recipe.set("seed", std::int64_t{2});
  further.recipe.set("part_lower", std::vector<double>{0, 0});
  // The further data were made later, when the family had wider bounds.
  further.recipe.set("upper_bounds", std::vector<double>{2, 1});
  const ModelData both{drawn_data(60), {further, drawn_data(5)}};
  const auto few = read_samples(alone);
  const auto all = read_samples(both);
  const auto split_alone = split(few);
  const auto split_both = split(all);
  EXPECT_GT(all.rows(), few.rows());
  EXPECT_EQ(split_both.test, split_alone.test);
  EXPECT_EQ(split_both.validation, split_alone.validation);
  EXPECT_EQ(split_both.row_test, split_alone.row_test);
  EXPECT_EQ(static_cast<int>(split_both.training.size() - split_alone.training.size()), all.rows() - few.rows());
  EXPECT_EQ(all.source.back().design, 60 + 25 + 4);
}

TEST(ReadSamples, FurtherDataThatWereSimulatedInAnotherWayAreRefused) {
  ModelData data{drawn_data(60), {drawn_data(3)}};
  data.data.recipe.set("mesh_size", 0.5);
  data.more[0].recipe.set("mesh_size", 1.0);
  testing::expect_error("dataset.different_recipe", [&] { (void)read_samples(data); });
}

}  // namespace
}  // namespace supple::training
