#include "supple/neural/evaluator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "supple/neural/uniaxial_frame.h"
#include "support/expect_error.h"
#include "support/random_network.h"

namespace supple::neural {
namespace {

NetworkShape shape_of(EnergyForm form, Activation activation, int width, int parameters) {
  NetworkShape shape;
  shape.form = form;
  shape.activation = activation;
  shape.width = width;
  shape.parameters = parameters;
  return shape;
}

/// The shape with the exact form of rest, with features of a tile, and with a stiffness branch of another depth.
NetworkShape extended(NetworkShape shape, int features, int stiffness_layers) {
  shape.rest = RestForm::exact;
  shape.features = features;
  shape.stiffness_layers = stiffness_layers;
  return shape;
}

class Evaluations : public ::testing::TestWithParam<NetworkShape> {
 public:
  void SetUp() override {
    const auto& shape = GetParam();
    network = random_network(shape, 3);
    for (int k = 0; k < shape.parameters; ++k)
      parameters.push_back(network.lower[k] + (0.2 + 0.15 * k) * (network.upper[k] - network.lower[k]));
    RandomStream stream("strains", 5);
    strains.resize(3, 29);
    for (long j = 0; j < strains.cols(); ++j)
      for (int i = 0; i < 3; ++i) strains(i, j) = stream.uniform(-0.3, 0.4);
  }

  /// The derivative of an evaluation's rows with respect to a parameter, or to a component of strain if `parameter` is
  /// negative. It is computed from central differences with Richardson extrapolation.
  template <class Rows>
  Eigen::MatrixXd differences(const Evaluator& evaluator, Rows rows, int strain, int parameter) const {
    const double scale = parameter < 0 ? 1 : network.upper[parameter] - network.lower[parameter];
    const double h = 1e-4 * scale;
    const auto at = [&](double step) -> Eigen::MatrixXd {
      auto moved = parameters;
      Eigen::Matrix3Xd e = strains;
      if (parameter >= 0)
        moved[static_cast<std::size_t>(parameter)] += step;
      else
        e.row(strain).array() += step;
      return rows(evaluator.evaluate(evaluator.design(moved), e, Order::third));
    };
    const Eigen::MatrixXd coarse = (at(2 * h) - at(-2 * h)) / (4 * h);
    const Eigen::MatrixXd fine = (at(h) - at(-h)) / (2 * h);
    return (4 * fine - coarse) / 3;
  }

  Network network;
  std::vector<double> parameters;
  Eigen::Matrix3Xd strains;
};

Eigen::MatrixXd energy_of(const Evaluation& e) { return e.energy_density; }
Eigen::MatrixXd stress_of(const Evaluation& e) { return e.stress; }
Eigen::MatrixXd tangent_of(const Evaluation& e) { return e.tangent; }

void expect_close(const Eigen::MatrixXd& value, const Eigen::MatrixXd& expected, double tolerance, const char* what) {
  ASSERT_EQ(value.rows(), expected.rows()) << what;
  ASSERT_EQ(value.cols(), expected.cols()) << what;
  EXPECT_LE((value - expected).cwiseAbs().maxCoeff(), tolerance * expected.cwiseAbs().maxCoeff()) << what;
}

void expect_strain_derivatives(const Evaluations& test) {
  const Evaluator evaluator(test.network);
  const auto exact = evaluator.evaluate(evaluator.design(test.parameters), test.strains, Order::third);
  const int pairs[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  const int triples[3][3][3] = {
      {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}, {{1, 3, 4}, {3, 6, 7}, {4, 7, 8}}, {{2, 4, 5}, {4, 7, 8}, {5, 8, 9}}};
  for (int k = 0; k < 3; ++k) {
    expect_close(exact.stress.row(k), test.differences(evaluator, energy_of, k, -1), 1e-7, "stress");
    const auto tangent = test.differences(evaluator, stress_of, k, -1);
    const auto third = test.differences(evaluator, tangent_of, k, -1);
    for (int i = 0; i < 3; ++i) {
      expect_close(exact.tangent.row(pairs[i][k]), tangent.row(i), 1e-7, "tangent");
      for (int j = i; j < 3; ++j)
        expect_close(exact.third.row(triples[i][j][k]), third.row(pairs[i][j]), 1e-6, "third");
    }
  }
}

void expect_parameter_derivatives(const Evaluations& test) {
  const Evaluator evaluator(test.network);
  const auto exact = evaluator.evaluate(evaluator.design(test.parameters, true), test.strains, Order::third);
  const int n = test.network.shape.parameters;
  for (int k = 0; k < n; ++k) {
    expect_close(exact.energy_by_parameters.row(k), test.differences(evaluator, energy_of, 0, k), 1e-7, "energy");
    const auto stress = test.differences(evaluator, stress_of, 0, k);
    for (int i = 0; i < 3; ++i) expect_close(exact.stress_by_parameters.row(i * n + k), stress.row(i), 1e-7, "stress");
    const auto tangent = test.differences(evaluator, tangent_of, 0, k);
    for (int i = 0; i < 6; ++i)
      expect_close(exact.tangent_by_parameters.row(i * n + k), tangent.row(i), 1e-6, "tangent");
  }
}

TEST_P(Evaluations, DerivativesByStrainAgreeWithDifferences) { expect_strain_derivatives(*this); }

TEST_P(Evaluations, DerivativesByParametersAgreeWithDifferences) { expect_parameter_derivatives(*this); }

/// The linear map of (E_xx, E_yy, 2 E_xy) for a rotation.
Eigen::Matrix3d rotation_of_strains(double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  Eigen::Matrix3d map;
  map << c * c, s * s, -c * s, s * s, c * c, c * s, 2 * c * s, -2 * c * s, c * c - s * s;
  return map;
}

TEST_P(Evaluations, SymmetriesHoldExactlyAndDerivativesAreThoseOfTheMean) {
  const Eigen::Matrix3d sixth = rotation_of_strains(std::numbers::pi / 3);
  network.symmetries = {sixth, sixth * sixth};
  const Evaluator evaluator(network);
  const auto design = evaluator.design(parameters);
  const auto answer = evaluator.evaluate(design, strains, Order::stress);
  const auto turned = evaluator.evaluate(design, sixth * strains, Order::stress);
  expect_close(turned.energy_density, answer.energy_density, 1e-12, "energy");
  expect_close(sixth.transpose() * turned.stress, answer.stress, 1e-12, "stress");
  auto without = network;
  without.symmetries.clear();
  const Evaluator one(without);
  EXPECT_GT(
      (one.evaluate(one.design(parameters), strains, Order::energy).energy_density - answer.energy_density).norm(),
      1e-3 * answer.energy_density.norm())
      << "the network has no such symmetry of its own";
  expect_strain_derivatives(*this);
  expect_parameter_derivatives(*this);
}

/// A random mesh correction for a network with this number of parameters.
Eigen::MatrixXd random_correction(int parameters, double size) {
  RandomStream stream("correction", 7);
  Eigen::MatrixXd correction(6, 1 + parameters + parameters * (parameters + 1) / 2);
  for (double& entry : correction.reshaped()) entry = stream.uniform(-size, size);
  return correction;
}

TEST_P(Evaluations, ACorrectionOfTheMeshIsAPartOfTheNetworkAndOfItsDerivatives) {
  if (network.shape.form == EnergyForm::softplus) GTEST_SKIP() << "it has no stiffness branch";
  const Evaluator plain(network);
  const auto before = plain.evaluate(plain.design(parameters), strains, Order::energy);
  network.mesh_correction = random_correction(network.shape.parameters, 0.1);
  const Evaluator evaluator(network);
  const auto after = evaluator.evaluate(evaluator.design(parameters), strains, Order::energy);
  EXPECT_GT((after.energy_density - before.energy_density).norm(), 1e-3 * before.energy_density.norm());
  expect_strain_derivatives(*this);
  expect_parameter_derivatives(*this);
}

TEST_P(Evaluations, ACorrectionOfEqualFactorsMultipliesTheEnergy) {
  if (network.shape.form == EnergyForm::softplus) GTEST_SKIP() << "it has no stiffness branch";
  const Evaluator plain(network);
  const auto before = plain.evaluate(plain.design(parameters), strains, Order::stress);
  network.mesh_correction = random_correction(network.shape.parameters, 0.1);
  network.mesh_correction.bottomRows(3).setZero();
  for (const int row : {1, 2}) network.mesh_correction.row(row) = network.mesh_correction.row(0);
  // Half the logarithm of the factor is computed here: a polynomial of degree 2 in the mapped parameters.
  double half = network.mesh_correction(0, 0);
  long term = 1;
  std::vector<double> mapped;
  for (int k = 0; k < network.shape.parameters; ++k)
    mapped.push_back(
        2 * (parameters[static_cast<std::size_t>(k)] - network.lower[k]) / (network.upper[k] - network.lower[k]) - 1);
  for (const double p : mapped) half += network.mesh_correction(0, term++) * p;
  for (std::size_t i = 0; i < mapped.size(); ++i)
    for (std::size_t j = i; j < mapped.size(); ++j) half += network.mesh_correction(0, term++) * mapped[i] * mapped[j];
  const Evaluator evaluator(network);
  const auto after = evaluator.evaluate(evaluator.design(parameters), strains, Order::stress);
  expect_close(after.energy_density, std::exp(2 * half) * before.energy_density, 1e-12, "energy");
  expect_close(after.stress, std::exp(2 * half) * before.stress, 1e-12, "stress");
}

TEST_P(Evaluations, EachOrderGivesTheSameNumbersAsHigherOnes) {
  const Evaluator evaluator(network);
  const auto design = evaluator.design(parameters);
  const auto third = evaluator.evaluate(design, strains, Order::third);
  for (const auto order : {Order::energy, Order::stress, Order::tangent}) {
    const auto lower = evaluator.evaluate(design, strains, order);
    expect_close(lower.energy_density, third.energy_density, 1e-14, "energy");
    if (order >= Order::stress) expect_close(lower.stress, third.stress, 1e-13, "stress");
    if (order >= Order::tangent) expect_close(lower.tangent, third.tangent, 1e-13, "tangent");
  }
}

TEST_P(Evaluations, OneStrainAloneIsAnsweredAsAmongOthers) {
  const Evaluator evaluator(network);
  const auto design = evaluator.design(parameters);
  const auto together = evaluator.evaluate(design, strains, Order::tangent);
  for (long j = 0; j < strains.cols(); ++j) {
    const auto alone = evaluator.evaluate(design, strains.col(j), Order::tangent);
    expect_close(alone.tangent, together.tangent.col(j), 1e-12, "tangent");
  }
}

TEST_P(Evaluations, SinglePrecisionIsCloseByItsRounding) {
  const Evaluator evaluator(network);
  const SingleEvaluator single(network);
  const auto exact = evaluator.evaluate(evaluator.design(parameters), strains, Order::tangent);
  const auto rounded = single.evaluate(single.design(parameters), strains, Order::tangent);
  expect_close(rounded.energy_density, exact.energy_density, 2e-5, "energy");
  expect_close(rounded.stress, exact.stress, 1e-4, "stress");
  expect_close(rounded.tangent, exact.tangent, 5e-4, "tangent");
  EXPECT_GT((rounded.stress - exact.stress).norm(), 0) << "it is not the same evaluator";
}

INSTANTIATE_TEST_SUITE_P(
    Networks, Evaluations,
    ::testing::Values(shape_of(EnergyForm::sum_of_squares, Activation::swish, 40, 4),
                      shape_of(EnergyForm::sum_of_squares, Activation::swish, 8, 1),
                      shape_of(EnergyForm::sum_of_squares, Activation::tanh, 24, 2),
                      shape_of(EnergyForm::sum_of_squares, Activation::sine, 16, 3),
                      extended(shape_of(EnergyForm::sum_of_squares, Activation::swish, 40, 4), 0, 2),
                      extended(shape_of(EnergyForm::sum_of_squares, Activation::swish, 24, 2), 23, 3),
                      extended(shape_of(EnergyForm::sum_of_squares, Activation::tanh, 16, 1), 10, 1),
                      extended(shape_of(EnergyForm::sum_of_squares, Activation::sine, 16, 3), 0, 4),
                      shape_of(EnergyForm::softplus, Activation::swish, 32, 2),
                      shape_of(EnergyForm::softplus, Activation::tanh, 16, 1)),
    [](const auto& tested) { return name_of(tested.param); });

TEST(SumOfSquares, EnergyAndStressVanishAtRestAndEnergyIsNowhereNegative) {
  NetworkShape shape;
  shape.width = 32;
  shape.parameters = 2;
  const auto network = random_network(shape, 8);
  const Evaluator evaluator(network);
  const auto design = evaluator.design(std::vector{0.2, 0.5});
  const auto rest = evaluator.evaluate(design, Eigen::Vector3d::Zero(), Order::tangent);
  EXPECT_LE(std::abs(rest.energy_density[0]), 1e-28);
  EXPECT_LE(rest.stress.norm(), 1e-14 * rest.tangent.norm());
  Eigen::Matrix3Xd strains = 3 * Eigen::Matrix3Xd::Random(3, 500);
  EXPECT_GE(evaluator.evaluate(design, strains, Order::energy).energy_density.minCoeff(), 0);
}

/// L L^T of the stiffness branch, computed here from the branch's layers.
Eigen::Matrix3d stiffness_of_branch(const Network& network, const std::vector<double>& parameters) {
  const auto n = network.shape.parameters;
  Eigen::VectorXd x(network.shape.design_inputs());
  for (int k = 0; k < n; ++k)
    x[k] = 2 * (parameters[static_cast<std::size_t>(k)] - network.lower[k]) / (network.upper[k] - network.lower[k]) - 1;
  if (network.shape.features > 0)
    x.tail(network.shape.features) = evaluate_features(network.geometry, parameters, false);
  for (std::size_t i = 0; i < network.stiffness.size(); ++i) {
    x = (network.stiffness[i].weights * x + network.stiffness[i].bias).eval();
    if (i + 1 < network.stiffness.size()) x = (x.array() / (1 + (-x.array()).exp())).eval();
  }
  Eigen::Matrix3d l = Eigen::Matrix3d::Zero();
  l.diagonal() = x.head<3>().array().exp();
  l(1, 0) = x[3] * l(0, 0);
  l(2, 0) = x[4] * l(0, 0);
  l(2, 1) = x[5] * l(1, 1);
  return l * l.transpose();
}

TEST(SumOfSquares, WithTheExactFormOfRestItsHessianThereIsTheStiffnessBranchAlone) {
  NetworkShape shape;
  shape.width = 32;
  shape.parameters = 3;
  shape = extended(shape, 20, 3);
  auto network = random_network(shape, 8);
  const std::vector<double> parameters{0.2, 0.3, 0.9};
  const auto wanted = stiffness_of_branch(network, parameters);
  const auto tangent_at_rest = [&] {
    const Evaluator evaluator(network);
    const auto rest = evaluator.evaluate(evaluator.design(parameters), Eigen::Vector3d::Zero(), Order::tangent);
    EXPECT_LE(std::abs(rest.energy_density[0]), 1e-28);
    EXPECT_LE(rest.stress.norm(), 1e-14 * wanted.norm());
    return symmetric_matrix(rest.tangent.col(0));
  };
  EXPECT_LE((tangent_at_rest() - wanted).norm(), 1e-13 * wanted.norm());
  const Eigen::Matrix3d sixth = rotation_of_strains(std::numbers::pi / 3);
  network.symmetries = {sixth, sixth * sixth};
  Eigen::Matrix3d mean = wanted / 3;
  for (const auto& map : network.symmetries) mean += map.transpose() * wanted * map / 3;
  EXPECT_LE((tangent_at_rest() - mean).norm(), 1e-13 * wanted.norm());
  network.symmetries.clear();
  network.shape.rest = RestForm::free;
  EXPECT_GT((tangent_at_rest() - wanted).norm(), 1e-2 * wanted.norm()) << "its slope at rest counts";
}

TEST(Evaluator, FarOutsideItsRangeTheNumbersStayFinite) {
  NetworkShape shape;
  shape.width = 32;
  shape = extended(shape, 20, 2);
  const Evaluator evaluator(random_network(shape, 4));
  for (const double far : {1e3, 1e6, -1e6}) {
    const auto answer =
        evaluator.evaluate(evaluator.design(std::vector{far}), Eigen::Vector3d(far, -far, far), Order::third);
    EXPECT_TRUE(answer.energy_density.allFinite() && answer.stress.allFinite() && answer.tangent.allFinite() &&
                answer.third.allFinite())
        << far;
  }
}

TEST(Evaluator, AWrongNumberOfParametersIsRefusedWithTheRightOne) {
  NetworkShape shape;
  shape.width = 8;
  shape.parameters = 3;
  const Evaluator evaluator(random_network(shape, 4));
  const auto error = testing::expect_error("model.parameter_count", [&] {
    (void)evaluator.design(std::vector{0.1, 0.2});
  });
  EXPECT_NE(std::string(error.what()).find('3'), std::string::npos);
}

TEST(Network, ALayerThatDoesNotFitIsNamed) {
  NetworkShape shape;
  shape.width = 16;
  auto network = random_network(shape, 1);
  network.trunk[2].weights.conservativeResize(16, 15);
  const auto error = testing::expect_error("model.invalid_network", [&] { validate(network); });
  EXPECT_NE(std::string(error.what()).find("trunk/2"), std::string::npos) << error.what();
  network = random_network(shape, 1);
  network.parameter[1].bias[3] = std::numeric_limits<double>::quiet_NaN();
  testing::expect_error("model.invalid_network", [&] { validate(network); });
  network = random_network(shape, 1);
  network.symmetries = {Eigen::Matrix3d::Constant(std::numeric_limits<double>::infinity())};
  testing::expect_error("model.invalid_network", [&] { validate(network); });
  network = random_network(shape, 1);
  for (const auto& unfit : {Eigen::MatrixXd::Zero(6, 4).eval(), Eigen::MatrixXd::Zero(5, 3).eval(),
                            Eigen::MatrixXd::Constant(6, 3, std::numeric_limits<double>::infinity()).eval()}) {
    network.mesh_correction = unfit;
    const auto wrong = testing::expect_error("model.invalid_network", [&] { validate(network); });
    EXPECT_NE(std::string(wrong.what()).find("mesh_correction"), std::string::npos) << wrong.what();
  }
  network = random_network(extended(shape, 12, 2), 1);
  network.geometry.features[3].edge = 5;
  testing::expect_error("model.invalid_network", [&] { validate(network); });
  network.geometry.features.resize(11);
  testing::expect_error("model.invalid_network", [&] { validate(network); });
  network = random_network(shape, 1);
  network.shape.form = EnergyForm::softplus;
  network.shape.rest = RestForm::exact;
  testing::expect_error("model.invalid_network", [&] { validate(network); });
}

}  // namespace
}  // namespace supple::neural
