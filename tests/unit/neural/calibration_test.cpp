#include "supple/neural/calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "supple/files/hdf5_file.h"
#include "supple/neural/error_bars.h"
#include "support/expect_error.h"
#include "support/random_network.h"
#include "support/temporary_folder.h"
#include "support/test_calibration.h"

namespace supple::neural {
namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

Model model_with_bars() {
  NetworkShape shape;
  shape.width = 16;
  shape.parameters = 2;
  Model model;
  model.id = "bars";
  model.family = "IH21";
  model.network = random_network(shape, 3);
  model.strain_range = {-0.4, 0.8, 10};
  model.calibration = test::test_calibration(2);
  return model;
}

std::vector<double> middle_of(const Model& model) {
  const Eigen::VectorXd middle = 0.5 * (model.network.lower + model.network.upper);
  return {middle.begin(), middle.end()};
}

UniaxialPoint point_at(const Evaluator& evaluator, const Evaluator::Design& design, const Eigen::Vector3d& strain) {
  const auto answer = evaluator.evaluate(design, strain, Order::tangent);
  return {answer.energy_density[0], answer.stress.col(0), symmetric_matrix(answer.tangent.col(0))};
}

TEST(QuadraticTerms, AreOneAllNumbersAndTheirProducts) {
  const Eigen::Vector3d z(2, 3, 5);
  Eigen::VectorXd expected(10);
  expected << 1, 2, 3, 5, 4, 6, 10, 9, 15, 25;
  EXPECT_EQ(quadratic_terms(z), expected);
}

TEST(Offsets, AreLinearBetweenKnotsAndConstantBeyond) {
  const BarOffsets offsets{{-1, 1, 2}, {0, 4, 2}, {}};
  EXPECT_EQ(offsets.at(-7), 0);
  EXPECT_EQ(offsets.at(-1), 0);
  EXPECT_EQ(offsets.at(0.5), 3);
  EXPECT_EQ(offsets.at(1.25), 3.5);
  EXPECT_EQ(offsets.at(2), 2);
  EXPECT_EQ(offsets.at(9), 2);
}

TEST(ExpectedError, HoldsFeaturesWithinWhatWasSeenAndEndsAtTheLargest) {
  auto calibration = test::test_calibration(2);
  auto& scale = calibration.scales[0];
  Eigen::VectorXd features = Eigen::VectorXd::Zero(uniaxial_feature_count(2));
  EXPECT_NEAR(expected_error(calibration, Quantity::stress, features), 0.02, 1e-12);
  EXPECT_NEAR(expected_error(calibration, Quantity::poisson, features), 0.06, 1e-12);
  scale.coefficients[3] = 1;  // the linear coefficient of the third feature
  scale.least[2] = -1;
  scale.greatest[2] = 2;
  features[2] = 1;
  const double there = expected_error(calibration, Quantity::stress, features);
  EXPECT_NEAR(there, 0.0205 * std::exp(1) - 0.0005, 1e-12);
  features[2] = 50;
  EXPECT_NEAR(expected_error(calibration, Quantity::stress, features), 0.0205 * std::exp(2) - 0.0005, 1e-12);
  features[2] = -50;
  EXPECT_NEAR(expected_error(calibration, Quantity::stress, features), 0.0205 * std::exp(-1) - 0.0005, 1e-12);
  scale.coefficients[0] = -50;
  EXPECT_EQ(expected_error(calibration, Quantity::stress, features), 0) << "no bar is negative";
  scale.coefficients[0] = 1e300;
  EXPECT_EQ(expected_error(calibration, Quantity::stress, features), largest_error);
}

TEST(ErrorBars, SayHowFarAnAnswerIsToBeTrusted) {
  auto model = model_with_bars();
  const Evaluator evaluator(model.network);
  const auto parameters = middle_of(model);
  const auto design = evaluator.design(parameters);
  const UniaxialFrame frame(0.4);
  const Eigen::Vector3d strain = frame.strain(0.1, {-0.02, 0.01});
  const auto point = point_at(evaluator, design, strain);
  const auto ask = [&](Quantity quantity) {
    return ErrorBars(model, evaluator, design, parameters, true).uniaxial(quantity, frame, 0.1, strain, point);
  };
  EXPECT_NEAR(ask(Quantity::stress).error.value(), 0.02, 1e-12);
  EXPECT_NEAR(ask(Quantity::stiffness).error.value(), 0.04, 1e-12);
  EXPECT_TRUE(ask(Quantity::stress).in_range && ask(Quantity::stiffness).in_range);
  model.calibration->scales[0].given.offsets = {std::log(0.06)};
  EXPECT_NEAR(ask(Quantity::stress).error.value(), 0.0595, 1e-12);
  EXPECT_FALSE(ask(Quantity::stress).in_range) << "more than 5 % is not trusted";
  EXPECT_TRUE(ask(Quantity::stiffness).in_range);
  const auto at_strain =
      ErrorBars(model, evaluator, design, parameters, false).at_strain(strain, point.energy_density, point.stress);
  EXPECT_NEAR(at_strain.error.value(), 0.08, 1e-12);
  EXPECT_TRUE(at_strain.in_range);
}

TEST(ErrorBars, SayNothingWhereNobodyCan) {
  auto model = model_with_bars();
  const Evaluator evaluator(model.network);
  auto parameters = middle_of(model);
  const UniaxialFrame frame(0);
  const Eigen::Vector3d strain = frame.strain(0.1, {0, 0});
  const auto point = point_at(evaluator, evaluator.design(parameters), strain);
  const auto ask = [&](const UniaxialPoint& at) {
    const auto design = evaluator.design(parameters);
    return ErrorBars(model, evaluator, design, parameters, true).uniaxial(Quantity::stress, frame, 0.1, strain, at);
  };
  auto broken = point;
  broken.tangent(0, 0) = not_a_number;
  EXPECT_FALSE(ask(broken).in_range);
  EXPECT_FALSE(ask(broken).error.has_value());
  const double inside = std::exchange(parameters[0], model.network.upper[0] + 0.1);
  EXPECT_FALSE(ask(point).in_range);
  EXPECT_FALSE(ask(point).error.has_value()) << "outside of the bounds no data tell";
  parameters[0] = inside;
  model.calibration.reset();
  EXPECT_TRUE(ask(point).in_range) << "without error bars the ranges of training decide";
  EXPECT_FALSE(ask(point).error.has_value());
}

TEST(ErrorFeatures, AreFiniteAndContinuousThroughRest) {
  const auto model = model_with_bars();
  const Evaluator evaluator(model.network);
  const auto parameters = middle_of(model);
  const auto design = evaluator.design(parameters);
  const auto rest = point_at(evaluator, design, Eigen::Vector3d::Zero());
  const auto of_design = design_features(model.network, parameters, design.rest_stiffness(), rest.tangent);
  const UniaxialFrame frame(1.1);
  const auto at = [&](double given) {
    const Eigen::Vector3d strain = frame.strain(given, {0, 0});
    return uniaxial_features(of_design, frame, given, strain, point_at(evaluator, design, strain));
  };
  const auto here = at(0);
  ASSERT_EQ(here.size(), uniaxial_feature_count(2));
  EXPECT_TRUE(here.allFinite());
  for (const double step : {1e-9, -1e-9}) EXPECT_LT((at(step) - here).cwiseAbs().maxCoeff(), 1e-4) << step;
  const auto strains = strain_features(of_design, Eigen::Vector3d::Zero(), 0, Eigen::Vector3d::Zero());
  ASSERT_EQ(strains.size(), strain_feature_count(2));
  EXPECT_TRUE(strains.allFinite());
}

class CalibrationFile : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder;
  std::filesystem::path path = folder / "model.h5";
  Model model = model_with_bars();
};

TEST_F(CalibrationFile, ErrorBarsAreReadBack) {
  auto& scale = model.calibration->scales[1];
  scale.coefficients.setLinSpaced(-1, 1);
  scale.given.knots = {-2, 0.5};
  scale.given.offsets = {0.1, 0.2};
  write_model(path, model);
  const auto back = read_model(path).calibration;
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->level, 0.9);
  EXPECT_EQ(back->scales[1].coefficients, scale.coefficients);
  EXPECT_EQ(back->scales[1].given.offsets, scale.given.offsets);
  EXPECT_EQ(back->scales[3].given.judged.designs, 12);
  EXPECT_EQ(back->scales[3].given.judged.observed, (std::vector<double>{0.9, 0.92}));
  EXPECT_EQ(back->scales[3].given.judged.within_in_range, 400);
  const Eigen::VectorXd features = Eigen::VectorXd::Ones(uniaxial_feature_count(2));
  EXPECT_EQ(expected_error(*back, Quantity::stiffness, features),
            expected_error(*model.calibration, Quantity::stiffness, features));
}

TEST_F(CalibrationFile, BarsOfSearchedDesignsAreReadBack) {
  auto& scale = model.calibration->scales[0];
  scale.searched.knots = {-1, 1};
  scale.searched.offsets = {std::log(0.5), std::log(0.7)};
  scale.searched.judged.designs = 150;
  scale.searched.judged.observed = {0.89, 0.93};
  write_model(path, model);
  EXPECT_FALSE(read_model(path).calibration->by_fresh_designs);
  model.calibration->by_fresh_designs = true;
  write_model(path, model);
  const auto back = read_model(path).calibration;
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(back->by_fresh_designs);
  EXPECT_EQ(back->scales[0].searched.judged.designs, 150);
  EXPECT_EQ(back->scales[0].searched.judged.observed, (std::vector<double>{0.89, 0.93}));
  EXPECT_EQ(back->scales[0].given.judged.designs, 12);
  EXPECT_TRUE(back->scales[1].searched.knots.empty());
  const Eigen::VectorXd features = Eigen::VectorXd::Zero(uniaxial_feature_count(2));
  EXPECT_NEAR(expected_error(*back, Quantity::stress, features, Origin::searched), std::sqrt(0.35) - 0.0005, 1e-12);
  EXPECT_NEAR(expected_error(*back, Quantity::stress, features), 0.02, 1e-12);
  EXPECT_EQ(expected_error(*back, Quantity::stiffness, features, Origin::searched),
            expected_error(*back, Quantity::stiffness, features))
      << "without searched designs they have the bars of others";
}

TEST_F(CalibrationFile, AModelWithoutErrorBarsHasNone) {
  model.calibration.reset();
  write_model(path, model);
  EXPECT_FALSE(files::Hdf5Reader(path).contains("calibration"));
  EXPECT_FALSE(read_model(path).calibration.has_value());
}

TEST_F(CalibrationFile, ErrorBarsThatDoNotFitTheNetworkAreRefused) {
  const auto refused = [&](const char* what) {
    write_model(path, model);
    supple::testing::expect_error("file.unreadable", [&] { (void)read_model(path); });
    model = model_with_bars();
    SCOPED_TRACE(what);
  };
  model.calibration = test::test_calibration(3);
  refused("as many features as another network's");
  model.calibration->scales[2].coefficients[4] = not_a_number;
  refused("no number");
  model.calibration->scales[2].deviation[0] = 0;
  refused("a deviation of zero");
  model.calibration->scales[0].given.knots = {1, 0};
  model.calibration->scales[0].given.offsets = {1, 0};
  refused("knots that decrease");
  model.calibration->scales[0].given.offsets = {};
  refused("no offset");
  model.calibration->scales[0].searched.knots = {0, 1};
  model.calibration->scales[0].searched.offsets = {0};
  refused("too few offsets of searched designs");
}

}  // namespace
}  // namespace supple::neural
