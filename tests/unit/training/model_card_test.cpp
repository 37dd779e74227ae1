#include "supple/training/model_card.h"

#include <gtest/gtest.h>

#include <string>

#include "sample_data.h"
#include "supple/training/model_training.h"
#include "support/random_network.h"
#include "support/test_calibration.h"

namespace supple::training {
namespace {

ModelData data_of_card() {
  ModelData data;
  data.data.recipe.set("lower_bounds", std::vector<double>{-1, -1});
  data.data.recipe.set("upper_bounds", std::vector<double>{1, 1});
  for (int i = 0; i < 60; ++i) data.data.designs.push_back(dataset::sample_design(i));
  return data;
}

neural::Model model_of_card(const neural::NetworkShape& shape, const ModelData& data, bool freeze) {
  neural::Model model;
  model.id = "drawn";
  model.family = "IH28";
  model.network = neural::random_network(shape, 1);
  ModelOptions options;
  options.training.shape = shape;
  options.training.loss = LossKind::squared;
  options.training.freeze_stiffness = freeze;
  model.provenance.options = describe(options);
  model.provenance.rows = static_cast<std::int64_t>(split(read_samples(data)).training.size());
  return model;
}

bool says(const std::string& page, const std::string& text) { return page.find(text) != std::string::npos; }

TEST(ModelCard, SaysHowTheStiffnessAtRestWasLearnedAndFromWhat) {
  const auto data = data_of_card();
  neural::NetworkShape shape;
  shape.width = 16;
  shape.parameters = 2;
  shape.features = 5;
  shape.rest = neural::RestForm::exact;
  shape.stiffness_width = 32;
  shape.stiffness_layers = 3;
  auto model = model_of_card(shape, data, true);
  model.provenance.options.emplace_back("rest_designs", "12000");
  model.provenance.options.emplace_back("start_model", "other");
  model.provenance.options.emplace_back("start_data", "old.h5");
  const auto page = model_card(model, data, "errors.svg");
  EXPECT_TRUE(
      says(page, "Designs are read by 5 features of their tile beside the parameters (`--features geometric`)."));
  EXPECT_TRUE(
      says(page,
           "The stiffness branch has 3 hidden layers of 32, was fitted to the stiffness at rest of 12000 designs "
           "first (`--rest-data`) and then stayed as it was (`--freeze-stiffness`); the stiffness at rest is its "
           "own alone (`--rest exact`)."))
      << page;
  EXPECT_TRUE(says(page, "Training began with the model other of other data, old.h5 (`--start-foreign`)."));
  EXPECT_TRUE(says(page, "`loss squared`"));
}

TEST(ModelCard, SaysWhichSimulationsJudgedTheBars) {
  const auto data = data_of_card();
  neural::NetworkShape shape;
  shape.width = 16;
  shape.parameters = 2;
  auto model = model_of_card(shape, data, false);
  model.calibration = test::test_calibration(2);
  const auto held_out = model_card(model, data, "errors.svg");
  EXPECT_TRUE(says(held_out, "Judged on held-out designs,")) << held_out;
  EXPECT_FALSE(says(held_out, "searches have found"));
  EXPECT_FALSE(says(held_out, "without its correction of their mesh"));
  model.network.mesh_correction.setConstant(6, 6, 0.01);
  model.calibration->by_fresh_designs = true;
  auto& scale = model.calibration->scales[static_cast<std::size_t>(neural::Quantity::poisson)];
  scale.searched.knots = {0};
  scale.searched.offsets = {0};
  scale.searched.judged.designs = 150;
  scale.searched.judged.states = 900;
  scale.searched.judged.share = 0.89;
  scale.searched.judged.median_bar = 0.07;
  const auto fresh = model_card(model, data, "errors.svg");
  EXPECT_TRUE(says(fresh, "Judged on fresh designs, simulated without the error of the data's mesh,")) << fresh;
  EXPECT_TRUE(
      says(fresh, "| Poisson's ratio, of designs that searches have found | 150 | 900 | 89.0 % | 0.07 | 0.1 |"));
  EXPECT_FALSE(says(fresh, "stiffness along a uniaxial load, of designs"));
  EXPECT_TRUE(says(fresh, "as these have taught it, without its correction of their mesh"));
  const auto errors_of = [](const std::string& page) {
    return page.substr(0, page.find("## Error bars")).substr(page.find("## Where they are"));
  };
  EXPECT_EQ(errors_of(fresh), errors_of(held_out)) << "the data have the error of their mesh";
}

TEST(ModelCard, SaysNothingOfChoicesThatWereNotMade) {
  const auto data = data_of_card();
  neural::NetworkShape shape;
  shape.width = 16;
  shape.parameters = 2;
  shape.stiffness_layers = 1;
  const auto page = model_card(model_of_card(shape, data, false), data, "errors.svg");
  EXPECT_TRUE(says(page,
                   "The stiffness branch has 1 hidden layer of 64; the stiffness at rest is learned by all branches "
                   "(`--rest free`)."))
      << page;
  for (const char* choice : {"--features", "--rest-data", "--freeze-stiffness", "--start-foreign"})
    EXPECT_FALSE(says(page, choice)) << choice;
  shape.form = neural::EnergyForm::softplus;
  EXPECT_FALSE(says(model_card(model_of_card(shape, data, false), data, "errors.svg"), "stiffness branch"));
}

}  // namespace
}  // namespace supple::training
