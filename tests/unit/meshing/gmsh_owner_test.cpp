#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <thread>

#include "supple/meshing/planar_mesh.h"
#include "supple/meshing/tetrahedral_mesh.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::meshing {
namespace {

using supple::testing::expect_error;

using Polygon = std::vector<Eigen::Vector2d>;
using Face = PlanarFace;

const Polygon square = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
const Polygon hole = {{1, 1}, {1, 3}, {3, 3}, {3, 1}};

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }
double constant(const Eigen::Vector2d&) { return 0.5; }

TEST(GmshOwner, TrianglesFillAFaceAndItsBoundaryPointsComeFirst) {
  const PlanarMesh mesh = triangulate({{square, hole}}, constant);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(mesh.points[k], square[k]);
    EXPECT_EQ(mesh.points[4 + k], hole[k]);
  }
  double doubled = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const double here = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
    EXPECT_GT(here, 0);
    doubled += here;
  }
  EXPECT_NEAR(doubled, 24, 1e-12);
}

TEST(GmshOwner, ALargeSizeLeavesTheSidesOfTheBoundaryWhole) {
  const PlanarMesh mesh = triangulate({{square}}, [](const Eigen::Vector2d&) { return 100.0; });
  int sides = 0;
  for (const auto& [a, b, c] : mesh.triangles) sides += (a < 4 && b < 4) + (b < 4 && c < 4) + (c < 4 && a < 4);
  EXPECT_GE(sides, 4);
}

TEST(GmshOwner, FacesThatCrossThemselvesAreRefusedAndLeaveTheOwnerAsGoodAsNew) {
  const Polygon outside = {{3, 1}, {3, 3}, {6, 3}, {6, 1}}, bow_tie = {{0, 0}, {4, 4}, {4, 0}, {0, 4}};
  const Polygon overlapping = {{2, 2}, {2, 3.5}, {3.5, 3.5}, {3.5, 2}}, needle = {{0, 0}, {4, 0}, {4, 0}, {0, 0}};
  const Polygon twice = {{0, 0}, {0, 0}, {4, 0}, {4, 4}, {0, 4}};
  for (const Face& face :
       {Face{square, outside}, Face{bow_tie}, Face{square, hole, overlapping}, Face{needle}, Face{twice}}) {
    const Error error = expect_error("tiling.meshing_failed", [&] { triangulate({face}, constant); });
    EXPECT_NE(std::string(error.what()).find("Algorithm 6"), std::string::npos) << error.what();
    EXPECT_FALSE(triangulate({{square}}, constant).triangles.empty());
  }
}

TEST(GmshOwner, PrintsNothingAndLeavesSignalsAlone) {
  const std::vector<int> signals = {SIGINT, SIGTERM, SIGSEGV, SIGFPE, SIGABRT};
  std::vector<struct sigaction> before(signals.size());
  for (std::size_t k = 0; k < signals.size(); ++k) sigaction(signals[k], nullptr, &before[k]);
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  triangulate({{square, hole}}, constant);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  for (std::size_t k = 0; k < signals.size(); ++k) {
    struct sigaction after {};
    sigaction(signals[k], nullptr, &after);
    EXPECT_EQ(after.sa_handler, before[k].sa_handler) << "signal " << signals[k];
  }
}

TEST(GmshOwner, ThreadsThatMeshAtOnceGetWhatTheyGetAlone) {
  const surface::TriangleMesh sphere = testing::icosphere(2);
  const auto plane = [] { return triangulate({{square, hole}}, [](const Eigen::Vector2d&) { return 0.1; }); };
  const auto solid = [&] { return fill(sphere.positions(), sphere.faces(), {.element_size = 0.2}); };
  const PlanarMesh flat = plane();
  const TetrahedralMesh full = solid();
  std::array<int, 2> same{};
  std::thread other([&] {
    for (int k = 0; k < 5; ++k) {
      const TetrahedralMesh again = solid();
      same[1] += again.nodes == full.nodes && again.tetrahedra == full.tetrahedra;
    }
  });
  for (int k = 0; k < 5; ++k) {
    const PlanarMesh again = plane();
    same[0] += again.points == flat.points && again.triangles == flat.triangles;
  }
  other.join();
  EXPECT_EQ(same, (std::array<int, 2>{5, 5}));
}

}  // namespace
}  // namespace supple::meshing
