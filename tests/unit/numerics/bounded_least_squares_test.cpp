#include "supple/numerics/bounded_least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "supple/base/random.h"

namespace supple::numerics {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

/// A problem written as two functions.
class Problem : public ResidualFunction {
 public:
  std::function<VectorXd(const VectorXd&)> value;
  std::function<MatrixXd(const VectorXd&)> derivative;
  std::function<bool(const VectorXd&)> exists = [](const VectorXd&) { return true; };

  bool residuals(const VectorXd& x, VectorXd& r) override {
    EXPECT_TRUE(((x - lower).array() >= 0).all() && ((upper - x).array() >= 0).all()) << "left the bounds";
    last_ = x;
    if (!exists(x)) return false;
    r = value(x);
    return true;
  }
  void jacobian(MatrixXd& jacobian) override { jacobian = derivative(last_); }
  LeastSquaresResult solve(const VectorXd& x, const LeastSquaresOptions& options = {}) {
    return minimize_least_squares(*this, x, lower, upper, options);
  }

  VectorXd lower;
  VectorXd upper;

 private:
  VectorXd last_;
};

/// Rosenbrock's valley, minimum (1, 1).
Problem valley(double least, double most) {
  Problem problem;
  problem.lower = Vector2d(least, least);
  problem.upper = Vector2d(most, most);
  problem.value = [](const VectorXd& x) { return Vector2d(10 * (x[1] - x[0] * x[0]), 1 - x[0]); };
  problem.derivative = [](const VectorXd& x) { return (MatrixXd(2, 2) << -20 * x[0], 10, -1, 0).finished(); };
  return problem;
}

/// Distances from three points to a plane point that fit badly: the residuals stay large.
Problem trilateration() {
  Problem problem;
  problem.lower = Vector2d(-5, -5);
  problem.upper = Vector2d(5, 5);
  const auto centres = (MatrixXd(2, 3) << 0, 3, 1, 0, 0, 4).finished();
  const Eigen::Vector3d distances(0.1, 0.1, 0.1);
  problem.value = [=](const VectorXd& x) -> VectorXd {
    return (centres.colwise() - x).colwise().norm().transpose() - distances;
  };
  problem.derivative = [=](const VectorXd& x) -> MatrixXd {
    return -(centres.colwise() - x).colwise().normalized().transpose();
  };
  return problem;
}

double projected_gradient(const Problem& problem, const VectorXd& x) {
  const VectorXd gradient = problem.derivative(x).transpose() * problem.value(x);
  return ((x - gradient).cwiseMax(problem.lower).cwiseMin(problem.upper) - x).norm();
}

TEST(BoundedLeastSquares, FollowsACurvedValleyToItsEnd) {
  auto problem = valley(-2, 2);
  const auto result = problem.solve(Vector2d(-1.2, 1), {.tolerance = 1e-12});
  EXPECT_EQ(result.stopped, LeastSquaresTermination::reached);
  EXPECT_LT((result.x - Vector2d(1, 1)).norm(), 1e-8);
  EXPECT_LT(result.iterations, 40);
}

TEST(BoundedLeastSquares, EndsAtTheBoundWhereTheMinimumLiesBeyond) {
  auto problem = valley(-2, 0.5);
  const auto result = problem.solve(Vector2d(-1.2, 0.4), {.tolerance = 1e-14});
  EXPECT_EQ(result.stopped, LeastSquaresTermination::converged);
  EXPECT_LT((result.x - Vector2d(0.5, 0.25)).norm(), 1e-6);
  EXPECT_LT(projected_gradient(problem, result.x), 1e-6);
}

TEST(BoundedLeastSquares, StartsInACornerAndLeavesIt) {
  auto problem = valley(-2, 2);
  for (const Vector2d& corner : {Vector2d(-2, -2), Vector2d(2, -2), Vector2d(-2, 2), Vector2d(2, 2)})
    EXPECT_EQ(problem.solve(corner).stopped, LeastSquaresTermination::reached) << corner.transpose();
}

TEST(BoundedLeastSquares, LargeResidualsConvergeFastThanksToTheCurvatureEstimate) {
  auto problem = trilateration();
  const auto result = problem.solve(Vector2d(4, -4), {.tolerance = 1e-14});
  EXPECT_EQ(result.stopped, LeastSquaresTermination::converged);
  EXPECT_GT(result.norm, 1);
  EXPECT_LT(projected_gradient(problem, result.x), 1e-6);
  EXPECT_LE(result.iterations, 15);
}

TEST(BoundedLeastSquares, StaysWhereTheResidualsExist) {
  auto problem = valley(-2, 2);
  problem.exists = [](const VectorXd& x) { return std::abs(x[1] - x[0] * x[0]) < 0.1; };
  const auto result = problem.solve(Vector2d(-1.2, 1.4));
  EXPECT_LT((result.x - Vector2d(1, 1)).norm(), 1e-6) << result.x.transpose();
  EXPECT_GT(result.evaluations, result.iterations / 2);
}

TEST(BoundedLeastSquares, SaysThatTheResidualsDoNotExistAtTheStart) {
  auto problem = valley(-2, 2);
  problem.exists = [](const VectorXd&) { return false; };
  const auto result = problem.solve(Vector2d(1, 1));
  EXPECT_FALSE(result.defined);
  EXPECT_EQ(result.iterations, 0);
}

TEST(BoundedLeastSquares, AFlatProblemEndsAtOnce) {
  auto problem = valley(-2, 2);
  problem.value = [](const VectorXd&) { return Vector2d(1, 2); };
  problem.derivative = [](const VectorXd&) { return MatrixXd::Zero(2, 2); };
  const auto result = problem.solve(Vector2d(0.1, 0.2));
  EXPECT_EQ(result.stopped, LeastSquaresTermination::converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.x, Vector2d(0.1, 0.2));
}

TEST(BoundedLeastSquares, UnknownsWithoutInfluenceStayFinite) {
  auto problem = valley(-2, 2);
  problem.value = [](const VectorXd& x) { return Vector2d(x[0] - 1.5, 0); };
  problem.derivative = [](const VectorXd&) { return (MatrixXd(2, 2) << 1, 0, 0, 0).finished(); };
  const auto result = problem.solve(Vector2d(0, 0.3));
  EXPECT_EQ(result.stopped, LeastSquaresTermination::reached);
  EXPECT_NEAR(result.x[0], 1.5, 1e-9);
  EXPECT_NEAR(result.x[1], 0.3, 1e-9);
}

TEST(QuadraticInBox, AgreesWithTryingEveryActiveSet) {
  RandomStream random("box", 5);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 4;
    const auto number = [&random] { return random.normal(); };
    const MatrixXd root = MatrixXd::NullaryExpr(n, n, number);
    const MatrixXd hessian = root * root.transpose() + 1e-3 * MatrixXd::Identity(n, n);
    const VectorXd gradient = VectorXd::NullaryExpr(n, number);
    const VectorXd lower = -VectorXd::NullaryExpr(n, [&] { return random.uniform(); });
    const VectorXd upper = VectorXd::NullaryExpr(n, [&] { return random.uniform(); });
    const auto energy = [&](const VectorXd& s) { return gradient.dot(s) + 0.5 * s.dot(hessian * s); };
    double best = 0;
    int sets = 1;
    for (int i = 0; i < n; ++i) sets *= 3;
    for (int set = 0; set < sets; ++set) {
      VectorXd s = VectorXd::Zero(n);
      std::vector<Eigen::Index> free;
      for (int i = 0, rest = set; i < n; ++i, rest /= 3) {
        if (rest % 3 == 0) free.push_back(i);
        if (rest % 3 == 1) s[i] = lower[i];
        if (rest % 3 == 2) s[i] = upper[i];
      }
      const VectorXd right = -(gradient + hessian * s);
      const MatrixXd block = hessian(free, free);
      const VectorXd part = right(free);
      if (!free.empty()) {
        const VectorXd inner = block.ldlt().solve(part);
        s(free) = inner;
      }
      if (((s - lower).array() > -1e-12).all() && ((upper - s).array() > -1e-12).all())
        best = std::min(best, energy(s));
    }
    const VectorXd found = minimize_quadratic_in_box(hessian, gradient, lower, upper);
    EXPECT_TRUE(((found - lower).array() >= -1e-15).all() && ((upper - found).array() >= -1e-15).all());
    EXPECT_NEAR(energy(found), best, 1e-10 * (1 + std::abs(best))) << trial;
  }
}

}  // namespace
}  // namespace supple::numerics
