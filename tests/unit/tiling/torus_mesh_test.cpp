#include "torus_mesh.h"

#include <gtest/gtest.h>

#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;

// The unit square, divided into two triangles.
TriangleSoup solid_square() {
  return {.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, .seam = {1, 1, 1, 1}, .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

TEST(TorusMesh, ASolidSquareHasOneCornerThreeSidesAndNoOutline) {
  const PeriodicMesh mesh = wrap(solid_square(), Eigen::Matrix2d::Identity(), 0);
  EXPECT_EQ(mesh.nodes.cols(), 4);
  EXPECT_TRUE(mesh.outline.empty());
  EXPECT_EQ(mesh.solid_area(), 1);
  for (int t = 0; t < 2; ++t) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.corner(t, 3 + k), (mesh.corner(t, k) + mesh.corner(t, (k + 1) % 3)) / 2);
    }
  }
}

TEST(TorusMesh, PointsMatchAcrossTheEdgeOfTheLatticesCoordinates) {
  TriangleSoup soup = solid_square();
  // Rounding may put a point just below zero, and its partner just below or above one.
  soup.points[0].x() -= 1e-13;
  soup.points[1].y() += 1e-13;
  EXPECT_EQ(wrap(soup, Eigen::Matrix2d::Identity(), 0).nodes.cols(), 4);
}

TEST(TorusMesh, SidesWithoutAPartnerAreNamed) {
  TriangleSoup soup = solid_square();
  soup.points[2].y() += 0.01;
  const Error error = expect_error("tiling.mesh_not_periodic", [&] { wrap(soup, Eigen::Matrix2d::Identity(), 0); });
  ASSERT_FALSE(error.details().empty());
  EXPECT_EQ(error.details()[0].where.substr(0, 10), "side from ");
}

TEST(TorusMesh, TrianglesThatOverlapAreRefused) {
  TriangleSoup soup = solid_square();
  soup.triangles.push_back({0, 1, 2});
  const Error error = expect_error("tiling.mesh_not_periodic", [&] { wrap(soup, Eigen::Matrix2d::Identity(), 0); });
  EXPECT_NE(error.details()[0].message.find("more than one triangle"), std::string::npos);
}

TEST(TorusMesh, AnOutlineThatTheHolesDoNotHaveIsRefused) {
  TriangleSoup soup = solid_square();
  soup.triangles.pop_back();
  expect_error("tiling.mesh_not_periodic", [&] { wrap(soup, Eigen::Matrix2d::Identity(), 0); });
  soup.seam = {0, 0, 0, 0};
  const Error error = expect_error("tiling.mesh_not_periodic", [&] { wrap(soup, Eigen::Matrix2d::Identity(), 0); });
  EXPECT_EQ(error.details()[0].where, "outline");
}

}  // namespace
}  // namespace supple::tiling
