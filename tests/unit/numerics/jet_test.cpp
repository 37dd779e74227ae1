#include "supple/numerics/jet.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "supple/base/random.h"
#include "supple/numerics/derivative_check.h"

namespace supple::numerics {
namespace {

/// Checks a function of n jets, written once for jets, against differences of itself.
template <int n, typename Function>
void expect_exact(const Function& function, const Eigen::VectorXd& at) {
  const LocalFunction local = [&](const Eigen::VectorXd& step, int) {
    std::array<Jet<n>, n> x;
    for (int i = 0; i < n; ++i) x[static_cast<std::size_t>(i)] = Jet<n>::variable(at[i] + step[i], i);
    const Jet<n> value = function(x);
    Eigen::MatrixXd hessian(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) hessian(i, j) = value.hessian(i, j);
    return Evaluation{value.value, Eigen::Map<const Eigen::VectorXd>(value.first.data(), n), hessian};
  };
  const DerivativeCheck check = check_derivatives(local, n);
  EXPECT_LT(check.gradient.error, 1e-9) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-9) << check.summary();
}

Eigen::VectorXd random_place(RandomStream& random, Eigen::Index n) {
  Eigen::VectorXd at(n);
  for (double& x : at) x = random.uniform(0.5, 2);
  return at;
}

TEST(Jet, HasExactDerivativesOfEveryOperation) {
  RandomStream random("jets", 1);
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::VectorXd at = random_place(random, 3);
    expect_exact<3>([](const auto& x) { return x[0] * x[1] + x[2] * 3.0 - x[0]; }, at);
    expect_exact<3>([](const auto& x) { return x[0] * inverse(x[1] + x[2]) + 2.0 - x[2]; }, at);
    expect_exact<3>([](const auto& x) { return sqrt(x[0] * x[1]) + sin(x[1] * x[2]) * cos(x[0]); }, at);
    expect_exact<3>([](const auto& x) { return atan2(x[0] - x[2], x[1] * x[1]); }, at);
  }
}

TEST(Jet, HasTheValuesOfEveryOperation) {
  const double x = 1.3;
  const double y = -0.4;
  const auto a = Jet<2>::variable(x, 0);
  const auto b = Jet<2>::variable(y, 1);
  EXPECT_EQ((a + b).value, x + y);
  EXPECT_EQ((a - b).value, x - y);
  EXPECT_EQ((-a).value, -x);
  EXPECT_EQ((a + 2.0).value, x + 2);
  EXPECT_EQ((2.0 + a).value, 2 + x);
  EXPECT_EQ((2.0 - a).value, 2 - x);
  EXPECT_EQ((a * b).value, x * y);
  EXPECT_EQ((a * 3.0).value, x * 3);
  EXPECT_EQ((3.0 * a).value, 3 * x);
  EXPECT_EQ(inverse(a).value, 1 / x);
  EXPECT_EQ(sqrt(a).value, std::sqrt(x));
  EXPECT_EQ(sin(b).value, std::sin(y));
  EXPECT_EQ(cos(b).value, std::cos(y));
  EXPECT_EQ(atan2(b, a).value, std::atan2(y, x));
  const Vector3<Jet<2>> u{a, b, a + 1.0};
  const Vector3<Jet<2>> v{b, a, 2.0 - b};
  const Eigen::Vector3d p(x, y, x + 1);
  const Eigen::Vector3d q(y, x, 2 - y);
  EXPECT_NEAR(dot(u, v).value, p.dot(q), 1e-15);
  EXPECT_NEAR(norm(u).value, p.norm(), 1e-15);
  const auto crossed = cross(u, v);
  const auto difference = u - v;
  EXPECT_LT((Eigen::Vector3d(crossed.x.value, crossed.y.value, crossed.z.value) - p.cross(q)).norm(), 1e-15);
  EXPECT_LT((Eigen::Vector3d(difference.x.value, difference.y.value, difference.z.value) - (p - q)).norm(), 1e-15);
}

TEST(Jet, HasExactDerivativesOfVectors) {
  RandomStream random("jet vectors", 1);
  for (int trial = 0; trial < 5; ++trial) {
    const Eigen::VectorXd at = random_place(random, 6);
    expect_exact<6>(
        [](const auto& x) {
          const Vector3<Jet<6>> a{x[0], x[1], x[2]}, b{x[3], x[4], x[5]};
          return norm(cross(a, b)) + dot(a + b, x[0] * (a - b));
        },
        at);
  }
}

TEST(Jet, OfAnArcTangentIsRightInEveryQuadrant) {
  for (const double x : {-1.0, 0.7})
    for (const double y : {-0.4, 1.2})
      expect_exact<2>([](const auto& v) { return atan2(v[1], v[0]); }, Eigen::Vector2d(x, y));
}

}  // namespace
}  // namespace supple::numerics
