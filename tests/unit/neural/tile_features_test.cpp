#include "supple/neural/tile_features.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <vector>

#include "support/expect_error.h"
#include "support/random_network.h"

namespace supple::neural {
namespace {

/// A rectangle whose sides a and b are the parameters, with one feature of each kind.
TileGeometry rectangle() {
  const auto point = [](double by_a, double by_b) {
    Eigen::Matrix2Xd affine = Eigen::Matrix2Xd::Zero(2, 3);
    affine(0, 1) = by_a;
    affine(1, 2) = by_b;
    return affine;
  };
  TileGeometry geometry;
  geometry.vertices = {point(0, 0), point(1, 0), point(1, 1), point(0, 1)};
  geometry.translations = {point(1, 0), point(0, 1)};
  geometry.tiles = 1;
  geometry.beam_width = 0.1;
  for (int kind = 0; kind < 10; ++kind) geometry.features.push_back({static_cast<FeatureKind>(kind), 0, 2, 0, 1});
  return geometry;
}

TEST(TileFeatures, OfARectangleAreWhatItsSidesSay) {
  const auto values = evaluate_features(rectangle(), std::vector{2.0, 3.0}, false);
  const double w = 0.1;
  const double slack = 1e-3;  // Lengths are smoothed below a quarter of the beam width.
  EXPECT_NEAR(values(0, 0), 2 / w, 20 * slack);
  EXPECT_NEAR(values(1, 0), std::log(2 / w), slack);
  EXPECT_NEAR(values(2, 0), 1, slack);
  EXPECT_NEAR(values(3, 0), 0, slack);
  EXPECT_NEAR(values(4, 0), 0, slack) << "a right angle";
  EXPECT_NEAR(values(5, 0), 1, slack);
  // Vertex 2 is beside the end of edge 0. The nearest point is clamped smoothly, and thus at most a tenth of the edge
  // away from the end.
  EXPECT_NEAR(values(6, 0), std::log(3 / w), 0.01);
  EXPECT_NEAR(values(7, 0), 1, 0.01);
  EXPECT_NEAR(values(8, 0), w * (2 + 3) / (2 * 3), slack);
  EXPECT_NEAR(values(9, 0), std::log(w * (2 + 3) / (2 * 3)), slack);
}

TEST(TileFeatures, AVertexThatCrossesAnEdgeChangesItsSideAndClosesItsGap) {
  auto geometry = rectangle();
  geometry.features = {{FeatureKind::side, 0, 2, 0, 1}, {FeatureKind::log_gap, 0, 2, 0, 1}};
  const auto at = [&](double b) { return evaluate_features(geometry, std::vector{2.0, b}, false).col(0).eval(); };
  EXPECT_GT(at(0.5)[0], 0.9);
  EXPECT_LT(at(-0.5)[0], -0.9);
  EXPECT_NEAR(at(0)[0], 0, 1e-12);
  EXPECT_LT(at(0)[1], at(0.2)[1]);
}

TEST(TileFeatures, DerivativesAgreeWithDifferencesAlsoWhereTilesCrossThemselvesOrLengthsVanish) {
  RandomStream stream("features", 2);
  const auto constant_width = random_geometry(3, 50, stream);
  auto varying_width = constant_width;
  varying_width.beam_width = 0.3;
  varying_width.beam_width_slopes = {0.05, 0, -0.08};
  for (int trial = 0; trial < 40; ++trial) {
    const auto& geometry = trial % 2 == 0 ? constant_width : varying_width;
    std::vector<double> parameters;
    for (int k = 0; k < 3; ++k) parameters.push_back(stream.uniform(-1.2, 1.2));
    if (trial == 0) {
      // Parameters at which the length of edge 0 vanishes up to rounding.
      Eigen::Matrix2d map;
      const Eigen::Matrix2Xd edge = geometry.vertices[1] - geometry.vertices[0];
      map << edge(0, 1), edge(0, 2), edge(1, 1), edge(1, 2);
      const Eigen::Vector2d there = map.inverse() * -(edge.col(0));
      parameters = {there[0], there[1], 0};
    }
    const auto exact = evaluate_features(geometry, parameters, true);
    for (int k = 0; k < 3; ++k) {
      const auto at = [&](double step) -> Eigen::VectorXd {
        auto moved = parameters;
        moved[static_cast<std::size_t>(k)] += step;
        return evaluate_features(geometry, moved, false);
      };
      const double h = 2e-4;
      const Eigen::VectorXd coarse = (at(2 * h) - at(-2 * h)) / (4 * h);
      const Eigen::VectorXd fine = (at(h) - at(-h)) / (2 * h);
      const Eigen::VectorXd difference = (4 * fine - coarse) / 3;
      // At a kink, the difference would have an error of the size of the derivatives themselves.
      EXPECT_LE((exact.col(1 + k) - difference).cwiseAbs().maxCoeff(), 1e-6 * (1 + difference.cwiseAbs().maxCoeff()))
          << "trial " << trial;
    }
  }
}

TEST(TileFeatures, HaveTheWidthThatBeamsHaveAtTheParameters) {
  auto varying = rectangle();
  varying.beam_width = 0.2;
  varying.beam_width_slopes = {0.05, -0.01};
  auto constant = rectangle();
  constant.beam_width = 0.2 + 0.05 * 2 - 0.01 * 3;
  const std::vector parameters{2.0, 3.0};
  EXPECT_TRUE(
      evaluate_features(varying, parameters, false).isApprox(evaluate_features(constant, parameters, false), 1e-12));
}

TEST(TileFeatures, AreRefusedWhereBeamsHaveNoWidth) {
  auto geometry = rectangle();
  const Eigen::Vector2d lower(1, 2), upper(3, 4);
  const auto refused = [&] {
    testing::expect_error("model.invalid_network", [&] { validate(geometry, lower, upper); });
  };
  geometry.beam_width_slopes = {0.05};
  refused();
  geometry.beam_width_slopes = {0.05, std::nan("")};
  refused();
  geometry.beam_width_slopes = {0, -0.025};
  refused();
  geometry.beam_width_slopes = {0, -0.024};
  validate(geometry, lower, upper);
}

TEST(TileFeatures, AnUnknownFeatureIsRefusedWithTheKnownOnes) {
  const auto error = testing::expect_error("model.invalid_network", [] { (void)feature_kind_of("colour"); });
  EXPECT_NE(std::string(error.what()).find("log_gap"), std::string::npos);
}

}  // namespace
}  // namespace supple::neural
