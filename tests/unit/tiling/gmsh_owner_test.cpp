#include "gmsh_owner.h"

#include <gtest/gtest.h>

#include <csignal>
#include <thread>

#include "designs.h"
#include "polygon.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;

const Polygon square = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
const Polygon hole = {{1, 1}, {1, 3}, {3, 3}, {3, 1}};

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
  const Structure one = testing::preset_structure("IH01"), two = testing::preset_structure("IH22");
  const PeriodicMesh first = mesh_structure(one), second = mesh_structure(two);
  std::vector<int> same(2, 0);
  const auto repeat_meshing = [&same](int thread, const Structure& structure, const PeriodicMesh& expected) {
    for (int k = 0; k < 5; ++k) same[thread] += testing::identical(mesh_structure(structure), expected);
  };
  std::thread other([&] { repeat_meshing(1, two, second); });
  repeat_meshing(0, one, first);
  other.join();
  EXPECT_EQ(same, (std::vector<int>{5, 5}));
}

}  // namespace
}  // namespace supple::tiling
