#include "supple/embedded/network_plan.h"

#include <gtest/gtest.h>

#include "supple/base/cost_ledger.h"
#include "supple/embedded/network_builders.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using Kind = NeighbourSprings::Kind;

class NetworkPlans : public ::testing::Test {
 protected:
  /// The field and number that building the plan refuses, or "" if it refuses nothing.
  std::string refused(const NetworkPlan& plan, std::size_t points, std::size_t springs) {
    std::string told;
    const auto refuse = [&](std::string_view field, std::size_t count) {
      told = std::string(field) + " " + std::to_string(count);
      throw Error("request.limit_exceeded", told);
    };
    try {
      build_network(solver, plan, {points, springs, 300'000, refuse});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "request.limit_exceeded");
    }
    return told;
  }

  surface::GeodesicSolver solver{testing::share(testing::torus(12, 6))};
  std::size_t faces = static_cast<std::size_t>(solver.mesh().face_count());
};

TEST_F(NetworkPlans, FollowTheirRules) {
  CostLedger bill;
  const NetworkPlan plan{PointsInFaces{{0.2, 0.3, 0.5}}, NeighbourSprings{Kind::adjacent_faces, 0.1, 2}, {3}};
  EXPECT_TRUE(plan.builds());
  const auto built = build_network(solver, plan, {}, {.cost = &bill});
  EXPECT_EQ(built.network.points.size(), faces);
  EXPECT_EQ(2 * built.network.springs.size(), 3 * faces);
  EXPECT_EQ(built.network.springs[5].rest_length, 0.1);
  EXPECT_EQ(built.network.springs[5].weight, 2);
  EXPECT_EQ(built.network.fixed_points, std::vector<std::int32_t>{3});
  EXPECT_FALSE(built.triangles);
  ASSERT_EQ(bill.stages().size(), 2U);
  EXPECT_EQ(bill.stages()[0].name, "points");
  EXPECT_EQ(bill.stages()[1].name, "springs");

  const auto random =
      build_network(solver, {PoissonDiskPoints{0.5, 7}, NeighbourSprings{Kind::voronoi_dual, 0, 1}}, {});
  const auto same = poisson_disk_points(solver, 0.5, 7);
  ASSERT_EQ(random.network.points.size(), same.size());
  EXPECT_EQ(random.network.points.back().barycentric, same.back().barycentric);
  ASSERT_TRUE(random.triangles);
  EXPECT_FALSE(random.triangles->empty());
}

TEST_F(NetworkPlans, TakeWhatIsGivenAsItIs) {
  const std::vector<surface::SurfacePoint> points = points_in_faces(solver.mesh(), {0.2, 0.3, 0.5});
  const NetworkPlan plan{points, std::vector<Spring>{{0, 1, 0.5, 3}}};
  EXPECT_FALSE(plan.builds());
  CostLedger bill;
  const auto built = build_network(solver, plan, {1, 0, 0, {}}, {.cost = &bill});
  EXPECT_EQ(built.network.points.size(), points.size()) << "limits are those of rules";
  EXPECT_EQ(built.network.springs.size(), 1U);
  EXPECT_TRUE(bill.stages().empty());
}

TEST_F(NetworkPlans, MeasureMembranesWhereThePointsAre) {
  NetworkPlan plan{PoissonDiskPoints{0.5, 7}, NeighbourSprings{Kind::voronoi_dual, 0, 1}};
  plan.triangles = DualTriangles{};
  plan.rest_scale = 0.9;
  plan.material.youngs_modulus = 5;
  CostLedger bill;
  const auto both = build_network(solver, plan, {}, {.cost = &bill});
  ASSERT_FALSE(both.network.triangles.empty());
  EXPECT_EQ(both.network.material.youngs_modulus, 5);
  EXPECT_EQ(both.triangles->size(), both.network.triangles.size());
  const auto& first = both.network.triangles.front();
  EXPECT_NEAR(first.rest_lengths[1],
              0.9 * solver.distance(both.network.points[static_cast<std::size_t>(first.corners[1])],
                                    both.network.points[static_cast<std::size_t>(first.corners[2])]),
              1e-12);
  EXPECT_EQ(bill.stages().back().name, "triangles");

  plan.springs = std::vector<Spring>{};
  const auto alone = build_network(solver, plan, {});
  EXPECT_EQ(*alone.triangles, *both.triangles);
  EXPECT_TRUE(alone.network.springs.empty());
  plan.triangles = std::vector<std::array<std::int32_t, 3>>{first.corners};
  const auto one = build_network(solver, plan, {});
  ASSERT_EQ(one.network.triangles.size(), 1U);
  EXPECT_EQ(one.network.triangles[0].rest_lengths, first.rest_lengths);
  plan.triangles = std::vector<std::array<std::int32_t, 3>>{};
  EXPECT_FALSE(build_network(solver, plan, {}).triangles.has_value());
}

TEST_F(NetworkPlans, AreRefusedBeyondTheLimits) {
  const NetworkPlan dual{PointsInFaces{{0.2, 0.3, 0.5}}, NeighbourSprings{}};
  EXPECT_EQ(refused(dual, faces, 3 * faces / 2), "");
  EXPECT_EQ(refused(dual, faces - 1, 3 * faces / 2), "points " + std::to_string(faces));
  EXPECT_EQ(refused(dual, faces, 3 * faces / 2 - 1), "springs " + std::to_string(3 * faces / 2));
  // 300 points in one face and 200 in a neighbour are 60,000 pairs, which are counted before they are built.
  std::vector<surface::SurfacePoint> crowd(300, surface::SurfacePoint{FaceId{0}, {0.2, 0.3, 0.5}});
  const auto neighbour = surface::TriangleMesh::face_of(solver.mesh().twin(0));
  crowd.resize(500, surface::SurfacePoint{FaceId{neighbour}, {0.2, 0.3, 0.5}});
  EXPECT_EQ(refused({crowd, NeighbourSprings{}}, 1000, 59'999), "springs 60000");
  EXPECT_EQ(refused({crowd, NeighbourSprings{}}, 1000, 60'000), "");
  EXPECT_EQ(refused({PoissonDiskPoints{0.5, 7}, NeighbourSprings{Kind::voronoi_dual, 0, 1}}, 100'000, 10).substr(0, 8),
            "springs ");
}

}  // namespace
}  // namespace supple::embedded
