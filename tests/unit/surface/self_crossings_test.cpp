#include "supple/surface/self_crossings.h"

#include <gtest/gtest.h>

#include "supple/base/random.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

/// Two copies of a mesh, the second one moved.
TriangleMesh doubled(const TriangleMesh& mesh, const Eigen::Vector3d& by) {
  auto positions = mesh.positions();
  auto faces = mesh.faces();
  for (const Eigen::Vector3d& p : mesh.positions()) positions.push_back(p + by);
  for (const Triangle& face : mesh.faces())
    faces.push_back({face[0] + mesh.vertex_count(), face[1] + mesh.vertex_count(), face[2] + mesh.vertex_count()});
  return TriangleMesh::build(std::move(positions), std::move(faces));
}

TEST(SelfCrossings, OfTwoSpheresLieOnBoth) {
  const TriangleMesh mesh = testing::icosphere(2);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RandomStream stream("spheres", seed);
    const Eigen::Vector3d by(stream.uniform(0.5, 1.2), stream.uniform(-0.5, 0.5), stream.uniform(-0.5, 0.5));
    const auto crossings = find_self_crossings(doubled(mesh, by), 1000);
    ASSERT_GT(crossings.size(), 20u) << seed;
    for (const SelfCrossing& crossing : crossings) {
      EXPECT_NEAR(crossing.place.norm(), 1, 0.05);
      EXPECT_NEAR((crossing.place - by).norm(), 1, 0.05);
      EXPECT_NE(crossing.face < mesh.face_count(), crossing.crossed < mesh.face_count());
    }
    EXPECT_TRUE(find_self_crossings(doubled(mesh, 5 * by), 1000).empty());
  }
}

TEST(SelfCrossings, OfOneComponentAreFoundAndNamed) {
  // A vertex of a sphere is pulled through the opposite side.
  const TriangleMesh mesh = testing::icosphere(2);
  auto positions = mesh.positions();
  positions[0] *= -1.3;
  const TriangleMesh crossing = mesh.with_positions(positions);
  const Error error = testing::expect_error("solid.self_crossing", [&] { require_no_self_crossings(crossing); });
  ASSERT_FALSE(error.details().empty());
  EXPECT_EQ(error.details()[0].where.substr(0, 5), "face ");
  EXPECT_NE(error.details()[0].message.find("crosses face "), std::string::npos);
  EXPECT_NE(error.details()[0].message.find(" at ("), std::string::npos);
  EXPECT_NE(std::string(error.what()).find(error.details()[0].message), std::string::npos);
}

TEST(SelfCrossings, AreNotSeenInSurfacesThatOnlyTouchThemselves) {
  for (const TriangleMesh& mesh : {testing::torus(24, 12), testing::bumpy_cube(6), testing::genus3(2),
                                   testing::open_hemisphere(), testing::two_components()})
    EXPECT_TRUE(find_self_crossings(mesh, 10).empty());
  // Two boxes with a common side, as their own surfaces, and two that share a part of a side's plane.
  const std::vector<Eigen::Vector3d> box{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                         {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const std::vector<Triangle> sides{{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                    {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  const TriangleMesh mesh = TriangleMesh::build(box, sides);
  EXPECT_TRUE(find_self_crossings(doubled(mesh, {1, 0, 0}), 10).empty());
  EXPECT_TRUE(find_self_crossings(doubled(mesh, {1, 0.3, 0.2}), 10).empty());
  EXPECT_FALSE(find_self_crossings(doubled(mesh, {0.9, 0.3, 0.2}), 10).empty());
}

}  // namespace
}  // namespace supple::surface
