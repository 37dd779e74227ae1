#include "supple/training/model_calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "error_regression.h"
#include "supple/base/random.h"
#include "supple/neural/error_bars.h"
#include "supple/neural/uniaxial.h"
#include "supple/training/model_training.h"
#include "support/expect_error.h"
#include "support/random_network.h"

namespace supple::training {
namespace {

/// Standard deviation of the relative errors of the stress in the data below. It is ten times larger in one half of the
/// box.
double spread_at(const std::vector<double>& parameters) { return parameters[0] < 0 ? 0.004 : 0.04; }

neural::Model bent_model() {
  neural::NetworkShape shape;
  shape.width = 16;
  shape.parameters = 2;
  shape.stiffness_width = 16;
  neural::Model model;
  model.id = "made-up";
  model.family = "IH21";
  model.network = neural::random_network(shape, 11);
  model.network.lower = Eigen::Vector2d(-1, -1);
  model.network.upper = Eigen::Vector2d(1, 1);
  model.network.trunk.back().weights *= 0.05;
  model.strain_range = {-0.4, 0.8, 100};
  return model;
}

/// Uniaxial states of the network with random errors, in place of simulated ones. The calibration has to find the
/// standard deviation of the errors, which is `times` spread_at.
dataset::Dataset data_with_errors(const neural::Model& model, int designs, std::uint64_t seed = 1, double times = 1) {
  dataset::Dataset data;
  data.recipe.set("family", std::string("IH21"));
  data.recipe.set("lower_bounds", std::vector<double>{-1, -1});
  data.recipe.set("upper_bounds", std::vector<double>{1, 1});
  RandomStream random("data with errors", seed);
  const neural::Evaluator evaluator(model.network);
  for (int d = 0; d < designs; ++d) {
    dataset::Design design;
    design.index = d;
    design.parameters = {random.uniform(-1, 1), random.uniform(-1, 1)};
    const auto prepared = evaluator.design(design.parameters);
    for (std::int32_t p = 0; p < 2; ++p) {
      const double direction = random.uniform(0, std::numbers::pi);
      design.paths.push_back({dataset::LoadKind::uniaxial, direction, 1.1, 0, 5, 5, "converged", ""});
      const std::vector<double> strains{0.02, 0.04, 0.06, 0.08, 0.1};
      const auto states = neural::uniaxial_path(evaluator, prepared, p == 0 ? direction : -direction, strains);
      for (std::int32_t k = 0; k < 5; ++k) {
        const auto& state = states[static_cast<std::size_t>(k)];
        // The error is relative to the network's value.
        const double factor = 1 + times * spread_at(design.parameters) * random.normal();
        dataset::Row row;
        row.path = p;
        row.position = k;
        row.green_strain = {state.strain[0], state.strain[1], state.strain[2] / 2};
        row.energy_density = factor * state.energy_density;
        for (int i = 0; i < 3; ++i) row.stress[static_cast<std::size_t>(i)] = factor * state.stress[i];
        int at = 0;
        for (int i = 0; i < 3; ++i)
          for (int j = i; j < 3; ++j) row.tangent[static_cast<std::size_t>(at++)] = factor * state.tangent(i, j);
        design.rows.push_back(row);
      }
    }
    data.designs.push_back(design);
  }
  return data;
}

class Calibrate : public ::testing::Test {
 protected:
  Calibrate() {
    ModelOptions options;
    options.split.test = 0.3;
    options.split.validation = 0.2;
    model.provenance.options = describe(options);
    model.provenance.rows =
        static_cast<std::int64_t>(split(read_samples(data, options.samples), options.split).training.size());
  }
  neural::Model model = bent_model();
  ModelData data{data_with_errors(model, 200), {}};
};

TEST_F(Calibrate, BarsAreAsLongAsTheErrorsAndHoldOnDesignsThatTheyHaveNotSeen) {
  const auto calibrated = calibrate(model, data).model;
  const auto& judged = calibrated.calibration->of(neural::Quantity::stress).given.judged;
  EXPECT_EQ(judged.designs, 100);
  EXPECT_EQ(judged.states, 1000);
  EXPECT_NEAR(judged.share, 0.9, 0.03);
  for (const double share : judged.observed) EXPECT_NEAR(share, 0.9, 0.1);
  // 90 % of normally distributed errors are within 1.645 standard deviations.
  const neural::Evaluator evaluator(model.network);
  RandomStream random("other designs", 1);
  std::vector<double> narrow;
  std::vector<double> wide;
  int within = 0;
  const int others = 200;
  for (int i = 0; i < others; ++i) {
    const std::vector<double> parameters{random.uniform(-0.95, 0.95), random.uniform(-0.95, 0.95)};
    const auto design = evaluator.design(parameters);
    const neural::UniaxialFrame frame(random.uniform(0, std::numbers::pi));
    neural::UniaxialNewton newton(frame);
    const auto at = [&](const Eigen::Vector3d& strain) -> neural::UniaxialPoint {
      const auto answer = evaluator.evaluate(design, strain, neural::Order::tangent);
      return {answer.energy_density[0], answer.stress.col(0), neural::symmetric_matrix(answer.tangent.col(0))};
    };
    newton.start_from_rest(at(Eigen::Vector3d::Zero()));
    newton.go_to(0.05);
    while (newton.working()) newton.receive(at(newton.trial()));
    ASSERT_TRUE(newton.converged());
    const auto trust = neural::ErrorBars(calibrated, evaluator, design, parameters, true)
                           .uniaxial(neural::Quantity::stress, frame, 0.05, newton.strain(), newton.point());
    ASSERT_TRUE(trust.error.has_value());
    (parameters[0] < 0 ? narrow : wide).push_back(*trust.error);
    within += std::abs(spread_at(parameters) * random.normal()) <= *trust.error ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(within) / others, 0.9, 0.06);
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
  };
  EXPECT_NEAR(median(narrow), 1.645 * 0.004, 0.5 * 1.645 * 0.004);
  EXPECT_NEAR(median(wide), 1.645 * 0.04, 0.5 * 1.645 * 0.04);
}

/// The error bar of the stress of a design at a uniaxial strain of 0.05.
double stress_bar(const neural::Model& model, const std::vector<double>& parameters, neural::Origin origin) {
  const neural::Evaluator evaluator(model.network);
  const auto design = evaluator.design(parameters);
  const std::vector<double> strains{0.05};
  const auto state = neural::uniaxial_path(evaluator, design, 0.7, strains).front();
  const auto answer = evaluator.evaluate(design, state.strain, neural::Order::tangent);
  return neural::ErrorBars(model, evaluator, design, parameters, true, origin)
      .uniaxial(neural::Quantity::stress, neural::UniaxialFrame(0.7), 0.05, state.strain,
                {answer.energy_density[0], answer.stress.col(0), neural::symmetric_matrix(answer.tangent.col(0))})
      .error.value();
}

TEST_F(Calibrate, ReferencesJudgeTheCorrectedNetworkAndTheDataTheOneThatTheyTaught) {
  // The model's correction assumes that the mesh of the data makes energies a tenth too large.
  auto corrected = model;
  corrected.network.mesh_correction.setZero(6, 6);
  corrected.network.mesh_correction.col(0).head<3>().setConstant(0.5 * std::log(0.9));
  ReferenceData references;
  for (const std::uint64_t seed : {7, 8}) references.drawn.push_back(data_with_errors(corrected, 60, seed, 2));
  const auto result = calibrate(corrected, data, {}, references).model;
  const auto& judged = result.calibration->of(neural::Quantity::stress).given.judged;
  EXPECT_EQ(judged.designs, 120);
  EXPECT_NEAR(judged.share, 0.9, 0.03);
  // The bars show twice the spread of the data's errors, which the references have. The error of the mesh is not in
  // them.
  EXPECT_NEAR(stress_bar(result, {-0.5, 0}, neural::Origin::given), 1.645 * 0.008, 0.4 * 1.645 * 0.008);
  EXPECT_NEAR(stress_bar(result, {0.5, 0}, neural::Origin::given), 1.645 * 0.08, 0.4 * 1.645 * 0.08);
  EXPECT_EQ(stress_bar(result, {0.5, 0}, neural::Origin::searched),
            stress_bar(result, {0.5, 0}, neural::Origin::given));
}

TEST_F(Calibrate, DesignsThatSearchesHaveFoundHaveBarsOfTheirOwn) {
  ReferenceData references{{data_with_errors(model, 120, 7)}, {data_with_errors(model, 100, 9, 3)}};
  const auto result = calibrate(model, data, {}, references).model;
  const auto& scale = result.calibration->of(neural::Quantity::stress);
  EXPECT_EQ(scale.searched.judged.designs, 100);
  EXPECT_NEAR(scale.given.judged.share, 0.9, 0.03);
  EXPECT_NEAR(scale.searched.judged.share, 0.9, 0.03);
  for (const std::vector<double>& design : {std::vector{-0.5, 0.1}, std::vector{0.5, 0.1}})
    EXPECT_NEAR(stress_bar(result, design, neural::Origin::searched),
                3 * stress_bar(result, design, neural::Origin::given),
                1.2 * stress_bar(result, design, neural::Origin::given));
}

TEST_F(Calibrate, ReferencesOfAnotherStructureAreRefused) {
  ReferenceData references{{data_with_errors(model, 20, 7)}, {}};
  references.drawn.front().recipe = {};
  references.drawn.front().recipe.set("family", std::string("IH22"));
  testing::expect_error("dataset.different_recipe", [&] { (void)calibrate(model, data, {}, references); });
}

TEST_F(Calibrate, TheSameDataGiveTheSameBarsAndOtherModelsDataAreRefused) {
  const auto first = calibrate(model, data).model.calibration;
  const auto second = calibrate(model, data).model.calibration;
  for (std::size_t q = 0; q < first->scales.size(); ++q) {
    EXPECT_EQ(first->scales[q].coefficients, second->scales[q].coefficients);
    EXPECT_EQ(first->scales[q].given.offsets, second->scales[q].given.offsets);
  }
  testing::expect_error("training.different_data", [&] { (void)calibrate(model, {data_with_errors(model, 120), {}}); });
}

TEST_F(Calibrate, CountsWhatIsSaidToBeInRangeWithAndWithoutBars) {
  const auto calibrated = calibrate(model, data).model;
  const auto& judged = calibrated.calibration->of(neural::Quantity::stress).given.judged;
  EXPECT_EQ(judged.beyond + judged.within, judged.states);
  EXPECT_EQ(judged.beyond_in_box, judged.beyond) << "nothing lies outside of the ranges of training";
  EXPECT_GT(judged.beyond, 100) << "half of the designs err by 4 % in the root mean square";
  EXPECT_LT(judged.beyond_in_range, judged.beyond / 3) << "their bars are beyond 5 %";
}

TEST_F(Calibrate, TooFewHeldOutDesignsAreRefused) {
  auto few = data;
  few.data.designs.resize(6);
  ModelOptions options;
  model.provenance.options = describe(options);
  model.provenance.rows = static_cast<std::int64_t>(split(read_samples(few)).training.size());
  testing::expect_error("training.no_samples", [&] { (void)calibrate(model, few); });
}

TEST_F(Calibrate, ThePictureHasACurveOfEachQuantityInBothCharts) {
  const auto picture = calibration_plot(calibrate(model, data));
  std::size_t curves = 0;
  for (auto at = picture.find("<polyline"); at != std::string::npos; at = picture.find("<polyline", at + 1)) ++curves;
  EXPECT_EQ(curves, 8U);
  EXPECT_EQ(picture.find("nan"), std::string::npos);
  EXPECT_EQ(picture.substr(picture.size() - 7), "</svg>\n");
}

TEST(ConformalOffsets, AreQuantilesOfGroupsOfLikeRatings) {
  // The ratings are 0 ... 9. The log errors exceed them by 1 ... 5 in the lower half and by 10 ... 50 in the upper one.
  Eigen::VectorXd ratings(10);
  Eigen::VectorXd logarithms(10);
  for (int i = 0; i < 10; ++i) {
    ratings[i] = i;
    logarithms[i] = i + (i < 5 ? i + 1 : 10 * (i - 4));
  }
  const auto table = conformal_offsets(ratings, logarithms, 0.8, 2);
  EXPECT_EQ(table.knots, (std::vector<double>{2, 7}));
  EXPECT_EQ(table.offsets, (std::vector<double>{4, 40})) << "four of five are below or equal";
  EXPECT_EQ(conformal_offsets(ratings, logarithms, 1, 2).offsets, (std::vector<double>{5, 50}));
}

TEST(ErrorRegression, AFitDoesNotKnowTheFoldsThatAreLeftOut) {
  RandomStream random("regression", 2);
  ObservedErrors observed;
  observed.features = Eigen::MatrixXd(400, 2);
  observed.error.resize(400);
  for (int i = 0; i < 400; ++i) {
    observed.features.row(i) << random.normal(), random.normal();
    observed.fold.push_back(i % 4);
    observed.design.push_back(i);
    observed.error[i] = std::exp(-3 + observed.features(i, 0));
  }
  neural::ErrorScale scale;
  const ErrorRegression all(observed, 4, 0, scale);
  const auto without = all.fit(1, 2);
  const auto ratings = all.rate(without, 1);
  for (Eigen::Index i = 0; i < ratings.size(); ++i) EXPECT_NEAR(ratings[i], all.log_errors(1)[i], 0.25);
  for (int i = 0; i < 400; ++i)
    if (i % 4 == 1 || i % 4 == 2) observed.error[i] = 1;
  const ErrorRegression other(observed, 4, 0, scale);
  EXPECT_LT((other.fit(1, 2) - without).norm(), 1e-12);
  EXPECT_GT((other.fit(-1, -1) - all.fit(-1, -1)).norm(), 0.1);
}

}  // namespace
}  // namespace supple::training
