#include "supple/neural/uniaxial.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "support/expect_error.h"
#include "support/random_network.h"

namespace supple::neural {
namespace {

/// A network whose energy is exactly the quadratic s/2 |y|^2, because the weights of its last layer are zero. L is
/// sqrt(2) times (1; 0.4 1; 0.1 0.2 1) for all parameters.
Network quadratic_network() {
  NetworkShape shape;
  shape.width = 16;
  auto network = random_network(shape, 2);
  network.trunk.back().weights.setZero();
  network.stiffness[2].weights.setZero();
  const double log = 0.5 * std::log(2.0);
  network.stiffness[2].bias << log, log, log, 0.4, 0.1, 0.2;
  return network;
}

Eigen::Matrix3d stiffness() {
  Eigen::Matrix3d l;
  l << 1, 0, 0, 0.4, 1, 0, 0.1, 0.2, 1;
  l *= std::sqrt(2.0);
  return l * l.transpose();
}

TEST(Uniaxial, OfAQuadraticEnergyIsWhatLinearAlgebraSays) {
  const Evaluator evaluator(quadratic_network());
  const auto design = evaluator.design(std::vector{0.3});
  for (const double direction : {0.0, 0.4, 1.3, 2.9}) {
    const std::vector<double> strains{0.05, 0.3, -0.2};
    const auto states = uniaxial_path(evaluator, design, direction, strains);
    ASSERT_EQ(states.size(), 3U);
    const double c = std::cos(direction);
    const double s = std::sin(direction);
    // S = sigma d d^T and E = C^-1 S, where sigma follows from the given E_dd.
    const Eigen::Vector3d along(c * c, s * s, c * s);
    const Eigen::Vector3d engineering(c * c, s * s, 2 * c * s);
    const Eigen::Vector3d compliance = stiffness().inverse() * along;
    for (std::size_t i = 0; i < 3; ++i) {
      const double e_dd = c * c * compliance[0] + s * s * compliance[1] + c * s * compliance[2];
      const double sigma = strains[i] / e_dd;
      EXPECT_TRUE(states[i].converged);
      EXPECT_NEAR(states[i].directional_stress, sigma, 1e-9 * std::abs(sigma));
      EXPECT_LT((states[i].strain - sigma * compliance).norm(), 1e-9);
      EXPECT_NEAR(engineering.dot(states[i].stress), sigma, 1e-9 * std::abs(sigma));
    }
  }
}

TEST(Uniaxial, StatesAreInEquilibriumAndEnergiesIntegrateTheStress) {
  NetworkShape shape;
  shape.width = 32;
  auto network = random_network(shape, 12);
  for (auto& layer : network.strain) layer.weights *= 0.4;
  const Evaluator evaluator(network);
  const auto design = evaluator.design(std::vector{0.2});
  const double direction = 0.7;
  std::vector<double> strains;
  for (int i = 1; i <= 200; ++i) strains.push_back(0.001 * i);
  const auto states = uniaxial_path(evaluator, design, direction, strains);
  const Eigen::Vector2d d(std::cos(direction), std::sin(direction));
  const Eigen::Vector2d n(-d[1], d[0]);
  double work = 0.5 * states[0].directional_stress * 0.001;
  for (std::size_t i = 0; i < states.size(); ++i) {
    ASSERT_TRUE(states[i].converged) << i;
    EXPECT_LE(states[i].residual, 1e-10);
    Eigen::Matrix2d s;
    s << states[i].stress[0], states[i].stress[2], states[i].stress[2], states[i].stress[1];
    EXPECT_LT(std::abs(n.dot(s * n)) + std::abs(d.dot(s * n)), 1e-9 * s.norm());
    const Eigen::Vector3d e = states[i].strain;
    EXPECT_NEAR(d[0] * d[0] * e[0] + d[1] * d[1] * e[1] + d[0] * d[1] * e[2], strains[i], 1e-14);
    if (i > 0) work += 0.5 * (states[i].directional_stress + states[i - 1].directional_stress) * 0.001;
  }
  EXPECT_NEAR(work, states.back().energy_density, 1e-4 * work);
}

TEST(Uniaxial, AStrainWhereTheLengthVanishesIsRefusedByItsPlace) {
  const Evaluator evaluator(quadratic_network());
  const auto design = evaluator.design(std::vector{0.3});
  const auto error = testing::expect_error("model.invalid_load", [&] {
    (void)uniaxial_path(evaluator, design, 0, std::vector{0.1, -0.5});
  });
  EXPECT_EQ(testing::places(error), std::vector<std::string>{"green_strains/1"});
}

TEST(Uniaxial, FarOutsideNothingIsClaimed) {
  NetworkShape shape;
  shape.width = 16;
  const Evaluator evaluator(random_network(shape, 3));
  const auto states = uniaxial_path(evaluator, evaluator.design(std::vector{40.0}), 0.2, std::vector{30.0, -0.49});
  for (const auto& state : states) EXPECT_TRUE(!state.converged || state.residual <= 1e-10);
}

}  // namespace
}  // namespace supple::neural
