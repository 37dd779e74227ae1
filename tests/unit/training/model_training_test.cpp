#include "supple/training/model_training.h"

#include <gtest/gtest.h>

#include <string>

#include "sample_data.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/structure.h"
#include "support/expect_error.h"

namespace supple::training {
namespace {

/// Rest stiffness of a family's default structure, simulated.
Eigen::Matrix3d rest_stiffness(const tiling::Family& family) {
  std::vector<double> parameters;
  for (const auto& parameter : family.parameters) parameters.push_back(parameter.preset);
  microscale::SimulationOptions options;
  options.mesh.mesh_size = 0.5;
  microscale::Simulator simulator(tiling::make_structure(family, parameters), options);
  const auto result = simulator.run(microscale::GreenStrainLoad{{Eigen::Vector3d::Zero()}});
  return result.states.at(0).tangent;
}

TEST(StrainSymmetries, LeaveTheSimulatedStiffnessAsItIs) {
  for (const char* id : {"IH21", "IH22", "IH28", "IH29", "IH67"}) {
    const auto& family = tiling::family(id);
    const auto maps = strain_symmetries(family);
    const Eigen::Matrix3d stiffness = rest_stiffness(family);
    for (const auto& map : maps)
      EXPECT_LT((map.transpose() * stiffness * map - stiffness).norm(), 0.01 * stiffness.norm()) << id << "\n" << map;
  }
}

TEST(StrainSymmetries, AreAsManyAsTheFamilysDistinctOrientations) {
  EXPECT_EQ(strain_symmetries(tiling::family("IH01")).size(), 0U);
  EXPECT_EQ(strain_symmetries(tiling::family("IH21")).size(), 2U) << "sixfold rotation: three orientations of a strain";
  EXPECT_EQ(strain_symmetries(tiling::family("IH22")).size(), 1U) << "a mirror";
  EXPECT_EQ(strain_symmetries(tiling::family("IH28")).size(), 1U) << "a quarter turn";
  EXPECT_EQ(strain_symmetries(tiling::family("IH29")).size(), 3U) << "a quarter turn and mirrors";
  EXPECT_EQ(strain_symmetries(tiling::family("IH50")).size(), 1U) << "a mirror";
  EXPECT_EQ(strain_symmetries(tiling::family("IH67")).size(), 1U) << "a mirror of each tile";
}

/// Designs that are samples of nothing, but enough to be split.
dataset::Dataset drawn_data(int designs) {
  dataset::Dataset data;
  data.recipe.set("lower_bounds", std::vector<double>{-1, -1});
  data.recipe.set("upper_bounds", std::vector<double>{1, 1});
  for (int i = 0; i < designs; ++i) data.designs.push_back(dataset::sample_design(i));
  return data;
}

TEST(SamplesOfAModel, OfOtherDataThanItsOwnAreRefused) {
  const auto data = drawn_data(60);
  neural::Model model;
  model.provenance.options = describe(ModelOptions{});
  model.provenance.rows = static_cast<std::int64_t>(split(read_samples(data)).training.size());
  EXPECT_FALSE(samples_of(model, data).split.test.empty());
  testing::expect_error("training.different_data", [&] { (void)samples_of(model, drawn_data(80)); });
}

}  // namespace
}  // namespace supple::training
