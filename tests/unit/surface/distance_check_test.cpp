// The check that every search makes of its own distances.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "distance_check.h"
#include "supple/base/error.h"
#include "supple/surface/geodesic_solver.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

constexpr double unreached = std::numeric_limits<double>::infinity();

class DistanceCheck : public ::testing::Test {
 protected:
  DistanceCheck() {
    const SurfacePoint source = vertex_point(*mesh_, VertexId(0));
    distances_ = GeodesicSolver(mesh_).field({&source, 1}).vertex_distances();
  }
  void check(double relative_error = 0, double limit = unreached) const {
    check_distances(*mesh_, distances_, relative_error, limit);
  }
  std::string message() const {
    try {
      check();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "geodesic.inconsistent");
      return error.what();
    }
    return "no error";
  }

  // The grid has 5 by 5 vertices. Vertex 4 is its corner (4, 0), whose only neighbours are vertices 3 and 9.
  std::shared_ptr<const TriangleMesh> mesh_ = testing::share(testing::flat_grid(4, 4));
  std::vector<double> distances_;
};

TEST_F(DistanceCheck, PassesWhatASearchFinds) { EXPECT_NO_THROW(check()); }

TEST_F(DistanceCheck, NamesAVertexThatIsNotReachedAndItsNeighbour) {
  distances_[6] = unreached;
  EXPECT_NE(message().find("Vertex 6 is not reached, but the distance of vertex "), std::string::npos) << message();
}

TEST_F(DistanceCheck, NamesAVertexThatIsFartherThanItsNeighbourPlusTheEdge) {
  distances_[4] = 4 + 1e-7;
  EXPECT_NE(message().find("The distance of vertex 4 is 4.0000001, but the distance of vertex 3 is 3, "),
            std::string::npos)
      << message();
  distances_[4] = 4;
  EXPECT_NO_THROW(check());
}

TEST_F(DistanceCheck, AllowsTheErrorThatTheSearchWasAllowed) {
  distances_[4] = 4 * 1.04;
  EXPECT_NO_THROW(check(0.05));
  EXPECT_THROW(check(0.01), Error);
}

TEST_F(DistanceCheck, LetsVerticesBeyondTheLimitBeUnreached) {
  for (double& d : distances_)
    if (d > 2.5) d = unreached;
  EXPECT_NO_THROW(check(0, 2.5));
  EXPECT_THROW(check(0, 5), Error);
}

TEST_F(DistanceCheck, LetsOtherComponentsBeUnreached) {
  const TriangleMesh two = testing::two_components();
  std::vector<double> distances(static_cast<std::size_t>(two.vertex_count()), unreached);
  EXPECT_NO_THROW(check_distances(two, distances, 0, unreached));
  distances[0] = 0;
  EXPECT_THROW(check_distances(two, distances, 0, unreached), Error);
}

TEST_F(DistanceCheck, FindsATargetFartherThanAWayByItsNeighbours) {
  const SearchMesh search_mesh(mesh_);
  WindowSearch search(search_mesh);
  const SurfacePoint source = vertex_point(*mesh_, VertexId(0));
  for (const SurfacePoint& point :
       {vertex_point(*mesh_, VertexId(6)), SurfacePoint{FaceId(3), Eigen::Vector3d(0.2, 0.3, 0.5)}}) {
    SearchTarget target = make_target(search_mesh, point);
    search.run({&source, 1}, {&target, 1}, SearchSettings{}, Execution{});
    EXPECT_NO_THROW(check_target(search, target));
    target.best.length *= 3;
    EXPECT_THROW(check_target(search, target), Error);
    target.best = {};
    EXPECT_THROW(check_target(search, target), Error);
  }
}

}  // namespace
}  // namespace supple::surface
