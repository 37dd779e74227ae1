#include "supple/training/mesh_correction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "supple/base/random.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/uniaxial_frame.h"
#include "support/expect_error.h"
#include "support/random_network.h"

namespace supple::training {
namespace {

constexpr int parameters = 2;

/// A network whose stiffness at zero strain is that of its stiffness branch alone.
neural::Model exact_model() {
  neural::NetworkShape shape;
  shape.width = 16;
  shape.parameters = parameters;
  shape.stiffness_width = 16;
  shape.rest = neural::RestForm::exact;
  neural::Model model;
  model.id = "made-up";
  model.family = "IH21";
  model.network = neural::random_network(shape, 11);
  model.network.lower = Eigen::Vector2d(0, 2);
  model.network.upper = Eigen::Vector2d(1, 5);
  model.calibration.emplace();
  return model;
}

/// A correction that differs for each output, and changes stiffnesses by some per cent, as the error of a mesh does.
Eigen::MatrixXd small_correction() {
  RandomStream random("correction", 3);
  Eigen::MatrixXd correction(6, 6);
  for (double& entry : correction.reshaped()) entry = random.uniform(-0.01, 0.01);
  return correction;
}

Eigen::Matrix3d tangent_at_rest(const neural::Network& network, const std::vector<double>& design) {
  const neural::Evaluator evaluator(network);
  const auto rest = evaluator.evaluate(evaluator.design(design), Eigen::Vector3d::Zero(), neural::Order::tangent);
  return neural::symmetric_matrix(rest.tangent.col(0));
}

/// A data set of random designs at rest, with the network's stiffness in place of a simulated one.
dataset::Dataset designs_at_rest(const neural::Network& network, int designs, const char* family = "IH21") {
  dataset::Dataset data;
  data.recipe.set("family", std::string(family));
  RandomStream random("designs at rest", 1);
  for (int d = 0; d < designs; ++d) {
    dataset::Design design;
    design.index = d;
    design.parameters = {random.uniform(0, 1), random.uniform(2, 5)};
    const Eigen::Matrix3d c = tangent_at_rest(network, design.parameters);
    dataset::Row row;
    row.tangent = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
    design.rows.push_back(row);
    data.designs.push_back(std::move(design));
  }
  return data;
}

class MeshCorrection : public ::testing::Test {
 protected:
  MeshCorrection() {
    finer.mesh_correction = small_correction();
    data.data.recipe.set("family", std::string("IH21"));
    data.rest = {designs_at_rest(model.network, 60)};
  }
  neural::Model model = exact_model();
  neural::Network finer = model.network;
  ModelData data;
  MeshCorrectionReport report;
};

TEST_F(MeshCorrection, GivesTheStiffnessOfTheReferenceAtRest) {
  const auto corrected = with_mesh_correction(model, data, designs_at_rest(finer, 60), report);
  EXPECT_LT((corrected.network.mesh_correction - finer.mesh_correction).norm(), 1e-10);
  EXPECT_FALSE(corrected.calibration.has_value()) << "its bars were those of the network as it was trained";
  EXPECT_EQ(report.designs, 60);
  EXPECT_GT(report.uncorrected.median, 1e-4);
  EXPECT_LT(report.corrected.percentile_90, 1e-10);
  const std::vector<double> other{0.35, 2.6};
  const Eigen::Matrix3d wanted = tangent_at_rest(finer, other);
  EXPECT_LT((tangent_at_rest(corrected.network, other) - wanted).norm(), 1e-10 * wanted.norm());
  EXPECT_GT((tangent_at_rest(neural::without_mesh_correction(corrected.network), other) - wanted).norm(),
            1e-4 * wanted.norm());
}

TEST_F(MeshCorrection, PairsDesignsByTheirParametersAndPassesOverOthers) {
  auto reference = designs_at_rest(finer, 60);
  std::swap(reference.designs[3], reference.designs[40]);
  reference.designs[5].parameters[0] += 1e-3;
  reference.designs[6].rows.clear();
  const auto corrected = with_mesh_correction(model, data, reference, report);
  EXPECT_EQ(report.designs, 58);
  EXPECT_LT((corrected.network.mesh_correction - finer.mesh_correction).norm(), 1e-10);
}

TEST_F(MeshCorrection, IsJudgedByDesignsThatHadNoPartInIt) {
  // The scatter is not a polynomial of the parameters. It remains as an error that hardly depends on the number of
  // designs.
  auto reference = designs_at_rest(finer, 60);
  RandomStream random("scatter", 9);
  for (auto& design : reference.designs) {
    const double factor = 1 + 0.02 * random.normal();
    for (double& entry : design.rows.front().tangent) entry *= factor;
  }
  (void)with_mesh_correction(model, data, reference, report);
  EXPECT_NEAR(report.corrected.median, 0.6745 * 0.02, 0.005);
}

TEST_F(MeshCorrection, TooFewDesignsAndOtherStructuresAreRefused) {
  const auto few = testing::expect_error(
      "training.no_samples", [&] { (void)with_mesh_correction(model, data, designs_at_rest(finer, 23), report); });
  EXPECT_NE(std::string(few.what()).find("needs 24"), std::string::npos) << few.what();
  testing::expect_error("dataset.different_recipe",
                        [&] { (void)with_mesh_correction(model, data, designs_at_rest(finer, 60, "IH22"), report); });
}

}  // namespace
}  // namespace supple::training
