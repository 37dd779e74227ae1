#include "survey.h"

#include <gtest/gtest.h>

#include <cmath>

#include "supple/base/random.h"

namespace supple::design {
namespace {

/// Corrections of two samples that change smoothly over the box.
Eigen::VectorXd smooth(const Eigen::VectorXd& x) {
  return Eigen::Vector2d(0.3 + 0.2 * x[0] - 0.1 * x[1], 0.1 * std::sin(2 * x[0] + x[1]));
}

struct Samples {
  explicit Samples(int n) {
    RandomStream random("survey test", 1);
    for (int i = 0; i < n; ++i) {
      points.emplace_back(Eigen::Vector2d(random.uniform(0, 1), random.uniform(0, 1)));
      corrections.push_back(smooth(points.back()));
    }
  }
  std::vector<Eigen::VectorXd> points, corrections;
};

TEST(CorrectionField, HasTheCorrectionsWhereTheyAreKnownButForTheSmoothing) {
  const Samples samples(30);
  const CorrectionField field(samples.points, samples.corrections);
  for (std::size_t i = 0; i < samples.points.size(); ++i)
    EXPECT_LT((field.at(samples.points[i]) - samples.corrections[i]).norm(), 4e-3);
}

TEST(CorrectionField, InterpolatesBetweenThem) {
  const Samples samples(60);
  const CorrectionField field(samples.points, samples.corrections);
  for (const double a : {0.3, 0.5, 0.7}) {
    const Eigen::Vector2d x(a, 1 - a);
    EXPECT_LT((field.at(x) - smooth(x)).norm(), 0.02);
  }
}

TEST(CorrectionField, IsTheSameEverywhereForOnePoint) {
  const CorrectionField field({Eigen::Vector2d(0.2, 0.4)}, {Eigen::Vector2d(0.1, -0.3)});
  EXPECT_LT((field.at(Eigen::Vector2d(0.9, 0.1)) - Eigen::Vector2d(0.1, -0.3)).norm(), 1e-12);
}

TEST(CorrectionField, HasTheSlopeOfDifferences) {
  const Samples samples(20);
  const CorrectionField field(samples.points, samples.corrections);
  const Eigen::Vector2d x(0.41, 0.63);
  const Eigen::MatrixXd slope = field.slope(x);
  constexpr double h = 1e-6;
  for (Eigen::Index k = 0; k < 2; ++k) {
    const Eigen::VectorXd move = h * Eigen::Vector2d::Unit(k);
    EXPECT_LT((slope.col(k) - (field.at(x + move) - field.at(x - move)) / (2 * h)).norm(), 1e-8);
  }
}

TEST(CorrectionField, TakesWhatNeighboursDoNotShareForNoise) {
  Samples samples(30);
  samples.points.emplace_back(samples.points[0] + Eigen::Vector2d(1e-5, 0));
  samples.corrections.emplace_back(samples.corrections[0] + Eigen::Vector2d(0.01, 0.01));
  const CorrectionField field(samples.points, samples.corrections);
  EXPECT_LT(field.slope(samples.points[0] + Eigen::Vector2d(1e-3, 0)).norm(), 4);
  EXPECT_NEAR(field.at(samples.points[0])[0], samples.corrections[0][0] + 0.005, 5e-3);
}

}  // namespace
}  // namespace supple::design
