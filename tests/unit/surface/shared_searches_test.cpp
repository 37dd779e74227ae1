#include "shared_searches.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

/// Pairs from a point to `count` points on a ring of that radius.
std::vector<PointPair> ring(const TriangleMesh& mesh, int count, double radius) {
  const SurfacePoint middle = vertex_point(mesh, VertexId{0});
  std::vector<std::pair<double, std::int32_t>> near;
  for (std::int32_t v = 1; v < mesh.vertex_count(); ++v)
    near.emplace_back(std::abs((mesh.positions()[v] - mesh.positions()[0]).norm() - radius), v);
  std::ranges::sort(near);
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i)
    pairs.push_back({middle, vertex_point(mesh, VertexId{near[static_cast<std::size_t>(i)].second}), nullptr});
  return pairs;
}

std::vector<std::size_t> sizes(const std::vector<std::vector<std::size_t>>& groups) {
  std::vector<std::size_t> sizes;
  for (const auto& group : groups) sizes.push_back(group.size());
  std::ranges::sort(sizes, std::greater());
  return sizes;
}

TEST(SharedSearches, AreForManyTargetsOfOnePointAndNotForFew) {
  const TriangleMesh mesh = testing::icosphere(3);
  EXPECT_EQ(sizes(shared_searches(mesh, ring(mesh, 1, 0.5))), (std::vector<std::size_t>{1}));
  EXPECT_EQ(sizes(shared_searches(mesh, ring(mesh, 2, 1.9))), (std::vector<std::size_t>{1, 1}));
  EXPECT_EQ(sizes(shared_searches(mesh, ring(mesh, 7, 1.0))), std::vector<std::size_t>(7, 1));
  EXPECT_EQ(sizes(shared_searches(mesh, ring(mesh, 20, 1.0))), (std::vector<std::size_t>{20}));
  EXPECT_EQ(sizes(shared_searches(mesh, ring(mesh, 300, 1.0))), (std::vector<std::size_t>{256, 44}));
}

TEST(SharedSearches, LeaveAFarTargetToItself) {
  const TriangleMesh mesh = testing::icosphere(3);
  std::vector<PointPair> pairs = ring(mesh, 30, 0.2);
  const PointPair far = ring(mesh, 1, 2).front();
  pairs.insert(pairs.begin() + 10, far);
  const auto groups = shared_searches(mesh, pairs);
  EXPECT_EQ(sizes(groups), (std::vector<std::size_t>{30, 1}));
  EXPECT_EQ(std::ranges::find(groups, std::vector<std::size_t>{10}) != groups.end(), true);
}

TEST(SharedSearches, KeepPairsOfOtherPointsKnownPathsAndOtherComponentsApart) {
  const TriangleMesh mesh = testing::two_components();
  const std::vector<PathPoint> known;
  std::vector<PointPair> pairs = ring(mesh, 40, 0.5);
  pairs[3].known_path = &known;
  for (std::size_t i = 20; i < 40; ++i) pairs[i].from = pairs[0].to;
  const auto other = std::ranges::find_if(mesh.faces(), [&](const Triangle& face) {
    return mesh.component(static_cast<std::int32_t>(&face - mesh.faces().data())) != mesh.component(0);
  });
  pairs[5].to.face = FaceId{static_cast<std::int32_t>(other - mesh.faces().begin())};
  const auto groups = shared_searches(mesh, pairs);
  EXPECT_TRUE(std::ranges::find(groups, std::vector<std::size_t>{3}) != groups.end());
  EXPECT_TRUE(std::ranges::find(groups, std::vector<std::size_t>{5}) != groups.end());
  std::vector<std::size_t> all;
  for (const auto& group : groups)
    for (const std::size_t pair : group) {
      all.push_back(pair);
      EXPECT_EQ(pair < 20, group.front() < 20) << "one search has one source";
    }
  std::ranges::sort(all);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(all[i], i);
}

TEST(SharedSearches, GiveWhatSinglePairsGive) {
  const auto mesh = testing::share(testing::torus(24, 12));
  const GeodesicSolver solver(mesh);
  RandomStream random("shared_searches", 1);
  std::vector<PointPair> pairs;
  for (int source = 0; source < 4; ++source) {
    const SurfacePoint from = testing::random_point(*mesh, random);
    for (int i = 0; i < (source == 0 ? 40 : 3); ++i) pairs.push_back({from, testing::random_point(*mesh, random)});
  }
  std::vector<Geodesic> found(pairs.size());
  CostLedger cost;
  solver.pairs(pairs, found, {.derivatives = 2, .path = true}, {{}, nullptr, &cost});
  EXPECT_LT(shared_searches(*mesh, pairs).size(), pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Geodesic alone = solver.geodesic(pairs[i].from, pairs[i].to, {.derivatives = 2, .path = true});
    EXPECT_NEAR(found[i].distance, alone.distance, 1e-13 * alone.distance);
    if (!alone.unique || alone.competing_excess < 1e-6) continue;
    EXPECT_LT((found[i].derivatives->tangent_hessian - alone.derivatives->tangent_hessian).norm(), 1e-7);
  }
  EXPECT_FALSE(cost.stages().empty());
}

}  // namespace
}  // namespace supple::surface
