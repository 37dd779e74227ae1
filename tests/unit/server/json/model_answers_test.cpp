#include "supple/json/model_answers.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "support/test_calibration.h"
#include "support/test_model.h"

namespace supple::json {
namespace {

using nlohmann::json;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
const ModelVersion version{"ih21", "abc"};

neural::Evaluation two_strains() {
  neural::Evaluation values;
  values.energy_density = Eigen::RowVector2d(0.5, 0.25);
  values.stress.resize(3, 2);
  values.stress << 1, 4, 2, 5, 3, 6;
  values.tangent.resize(6, 2);
  values.tangent << 11, 0, 12, 0, 13, 0, 22, 0, 23, 0, 33, 0;
  return values;
}

json evaluation(neural::Order order) {
  return json::parse(write_evaluation(version, order, two_strains(), {{true, {}}, {}}, false, {}));
}

TEST(ModelAnswers, DescribeAModel) {
  const auto model = test::test_model("ih21", 1);
  const auto answer = json::parse(write_model(model, "abc"));
  EXPECT_EQ(answer["id"], "ih21");
  EXPECT_EQ(answer["family"], "IH21");
  EXPECT_EQ(answer["sha256"], "abc");
  EXPECT_EQ(answer["parameters"], (json{{"lower", {0.105, 0.505}}, {"upper", {0.195, 0.795}}}));
  EXPECT_EQ(answer["strain_range"]["largest_relative_energy"], 0.05);
  EXPECT_EQ(answer["errors"]["design_split"]["gradient"]["percentile_99"], 0.05)
      << "gradient and energy are told apart";
  EXPECT_EQ(answer["errors"]["design_split"]["energy"]["percentile_99"], 0.1);
  EXPECT_TRUE(answer["errors"]["row_split"].is_null());
  EXPECT_EQ(answer["network"]["form"], "sum_of_squares");
  EXPECT_EQ(answer["network"]["residuals"], 4);
  EXPECT_EQ(answer["network"]["weights"], model.network.weights());
  EXPECT_EQ(answer["provenance"]["options"], (json{{"kind", "random"}}));
  EXPECT_EQ(answer["material"], (json{{"youngs_modulus", 26.0}, {"poisson_ratio", 0.48}}));
}

TEST(ModelAnswers, SayWhatErrorBarsAreWorth) {
  auto model = test::test_model("ih21", 1);
  EXPECT_TRUE(json::parse(write_model(model, "abc"))["error_bars"].is_null());
  model.calibration = test::test_calibration(2);
  const auto bars = json::parse(write_model(model, "abc"))["error_bars"];
  EXPECT_EQ(bars["level"], 0.9);
  EXPECT_EQ(bars["judged_by"], "held_out");
  EXPECT_EQ(bars["stress"],
            (json{{"trusted", 0.05}, {"median", 0.02}, {"share", 0.91}, {"designs", 12}, {"samples", 480}}));
  EXPECT_EQ(bars["poisson"]["trusted"], 0.1);
}

TEST(ModelAnswers, SayWhichSimulationsJudgedTheBarsAndWhatThoseOfSearchesAreWorth) {
  auto model = test::test_model("ih21", 1);
  EXPECT_FALSE(json::parse(write_model(model, "abc"))["network"]["corrects_mesh"]);
  model.network.mesh_correction.setZero(6, 6);
  model.calibration = test::test_calibration(2);
  model.calibration->by_fresh_designs = true;
  auto& scale = model.calibration->scales[static_cast<std::size_t>(neural::Quantity::stiffness)];
  scale.searched.knots = {0};
  scale.searched.offsets = {0};
  scale.searched.judged.designs = 150;
  scale.searched.judged.states = 900;
  scale.searched.judged.share = 0.89;
  scale.searched.judged.median_bar = 0.07;
  const auto answer = json::parse(write_model(model, "abc"));
  EXPECT_TRUE(answer["network"]["corrects_mesh"]);
  EXPECT_EQ(answer["error_bars"]["judged_by"], "fresh");
  EXPECT_EQ(answer["error_bars"]["stiffness"]["searched"],
            (json{{"median", 0.07}, {"share", 0.89}, {"designs", 150}, {"samples", 900}}));
  EXPECT_FALSE(answer["error_bars"]["stress"].contains("searched"));
}

TEST(ModelAnswers, EscapeWhatFilesCallTheirOptions) {
  auto model = test::test_model("ih21", 1);
  model.provenance.options = {{"a\"b\\c", "\"x\""}, {"", "\xFF"}};
  const auto options = json::parse(write_model(model, "abc"))["provenance"]["options"];
  EXPECT_EQ(options["a\"b\\c"], "\"x\"");
  EXPECT_EQ(options[""], "\xEF\xBF\xBD");
}

TEST(ModelAnswers, RefuseAModelWhoseDescriptionIsNotFinite) {
  auto model = test::test_model("ih21", 1);
  model.design_split->gradient.mean = none;
  EXPECT_THROW(write_model(model, "abc"), Error);
}

TEST(EvaluationAnswers, HoldWhatWasAskedForAndNoMore) {
  const auto energies = evaluation(neural::Order::energy);
  EXPECT_EQ(energies["model"], "ih21");
  EXPECT_EQ(energies["sha256"], "abc");
  EXPECT_EQ(energies["energy_density"], (json{0.5, 0.25}));
  EXPECT_EQ(energies["in_range"], (json{true, false}));
  EXPECT_FALSE(energies.contains("stress"));
  const auto stresses = evaluation(neural::Order::stress);
  EXPECT_EQ(stresses["stress"], (json{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_FALSE(stresses.contains("tangent"));
  EXPECT_TRUE(stresses["stress_error_bar"].is_null() && !energies.contains("stress_error_bar"));
  const auto tangents = evaluation(neural::Order::tangent);
  EXPECT_EQ(tangents["tangent"][0], (json{{11, 12, 13}, {12, 22, 23}, {13, 23, 33}}));
}

TEST(EvaluationAnswers, HaveErrorBarsInTheNormOfTheStress) {
  auto values = two_strains();
  values.stress.col(0) << 2, 3, 6;
  const auto answer =
      json::parse(write_evaluation(version, neural::Order::stress, values, {{true, 0.5}, {}}, true, {}));
  EXPECT_EQ(answer["stress_error_bar"][0], 3.5);
  EXPECT_TRUE(answer["stress_error_bar"][1].is_null());
}

TEST(EvaluationAnswers, RefuseAnEnergyThatIsNotFinite) {
  auto values = two_strains();
  values.energy_density[1] = none;
  try {
    write_evaluation(version, neural::Order::energy, values, {{}, {}}, false, {});
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "computation.non_finite");
  }
}

TEST(UniaxialAnswers, HalveTheShearAndReportTheWorstResidual) {
  std::vector<neural::UniaxialState> states(2);
  states[0].strain = {0.1, 0.2, 0.5};
  states[0].residual = 1e-12;
  states[0].converged = true;
  states[1].residual = 1e-3;
  states[1].iterations = 7;
  UniaxialRequest request;
  request.parameters = {0.15, 0.65};
  request.direction = 0.5;
  states[0].directional_stress = -8;
  const auto answer = json::parse(write_uniaxial(version, request, states, {{true, 0.125}, {}}, {}));
  EXPECT_EQ(answer["states"][0]["error_bar"], 1.0) << "a share of the stress, in MPa";
  EXPECT_TRUE(answer["states"][1]["error_bar"].is_null());
  EXPECT_EQ(answer["parameters"], (json{0.15, 0.65}));
  EXPECT_EQ(answer["direction"], 0.5);
  EXPECT_EQ(answer["states"][0]["green_strain"], (json{0.1, 0.2, 0.25})) << "tensor components";
  EXPECT_EQ(answer["states"][0]["converged"], true);
  EXPECT_EQ(answer["states"][0]["in_range"], true);
  EXPECT_EQ(answer["states"][1]["in_range"], false);
  EXPECT_EQ(answer["states"][1]["iterations"], 7);
  EXPECT_EQ(answer["accuracy"]["residual"], 1e-3);
  EXPECT_EQ(answer["accuracy"]["tolerance"], 1e-10);
}

TEST(UniaxialAnswers, SayNullWhereAStateHasNoResidual) {
  std::vector<neural::UniaxialState> states(2);
  states[0].residual = none;
  states[1].residual = 1e-3;
  const auto answer = json::parse(write_uniaxial(version, {}, states, {{}, {}}, {}));
  EXPECT_TRUE(answer["states"][0]["residual"].is_null());
  EXPECT_TRUE(answer["accuracy"]["residual"].is_null());
}

}  // namespace
}  // namespace supple::json
