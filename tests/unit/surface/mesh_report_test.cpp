#include "supple/surface/mesh_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/shapes.h"

namespace supple::surface {
namespace {

using std::numbers::pi;

struct Topology {
  std::int64_t faces, components, boundary_loops, genus;
  bool operator==(const Topology&) const = default;
};

Topology topology(const TriangleMesh& mesh) {
  const MeshReport r = report(mesh);
  return {r.faces, r.components, r.boundary_loops, r.genus};
}

std::ostream& operator<<(std::ostream& out, const Topology& t) {
  return out << t.faces << " faces, " << t.components << " components, " << t.boundary_loops << " loops, genus "
             << t.genus;
}

TEST(MeshReport, CountsComponentsBoundaryLoopsAndGenus) {
  EXPECT_EQ(topology(testing::icosphere(3)), (Topology{1280, 1, 0, 0}));
  EXPECT_EQ(topology(testing::torus()), (Topology{2304, 1, 0, 1}));
  EXPECT_EQ(topology(testing::genus3()), (Topology{2176, 1, 0, 3}));
  EXPECT_EQ(topology(testing::cube(4)), (Topology{192, 1, 0, 0}));
  EXPECT_EQ(topology(testing::bumpy_cube(10)), (Topology{1200, 1, 0, 0}));
  EXPECT_EQ(topology(testing::spiral_cup(100, 10)), (Topology{2000, 1, 0, 0}));
  EXPECT_EQ(topology(testing::trefoil_knot()), (Topology{3840, 1, 0, 1}));
  EXPECT_EQ(topology(testing::sliver_sphere()), (Topology{768, 1, 0, 0}));
  EXPECT_EQ(topology(testing::two_components()), (Topology{896, 2, 0, 1}));
  EXPECT_EQ(topology(testing::saddle(20)), (Topology{800, 1, 1, 0}));
  EXPECT_EQ(topology(testing::open_hemisphere()), (Topology{608, 1, 1, 0}));
  EXPECT_EQ(topology(testing::slit_annulus()), (Topology{480, 1, 1, 0}));
  EXPECT_EQ(topology(testing::l_shape(4)), (Topology{96, 1, 1, 0}));
  EXPECT_EQ(topology(testing::needle_cylinder()), (Topology{96, 1, 2, 0}));
  EXPECT_EQ(topology(testing::cone(8, 9.0, 3)), (Topology{40, 1, 1, 0}));
}

TEST(MeshReport, CountsSaddleVerticesAndNotTheFlatOnes) {
  EXPECT_EQ(report(testing::saddle(20)).saddle_vertices, 19 * 19);
  EXPECT_EQ(report(testing::icosphere(3)).saddle_vertices, 0);
  EXPECT_EQ(report(testing::flat_grid(30, 20)).saddle_vertices, 0);
  RandomStream stream("jittered report", 1);
  EXPECT_EQ(report(testing::jittered_grid(30, 20, stream)).saddle_vertices, 0);
  EXPECT_EQ(report(testing::cone(10, 9.0, 3)).saddle_vertices, 1);
  EXPECT_EQ(report(testing::cone(10, 6.0, 3)).saddle_vertices, 0);
}

TEST(MeshReport, MeasuresTheShape) {
  const MeshReport cube = report(testing::cube(2));
  EXPECT_EQ(cube.vertices, 26);
  EXPECT_EQ(cube.edges, 72);
  EXPECT_DOUBLE_EQ(cube.area, 6);
  EXPECT_EQ(cube.lower, Eigen::Vector3d::Zero());
  EXPECT_EQ(cube.upper, Eigen::Vector3d::Ones());
  EXPECT_DOUBLE_EQ(cube.edge_min, 0.5);
  EXPECT_DOUBLE_EQ(cube.edge_max, std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(cube.edge_mean, (48 * 0.5 + 24 * std::sqrt(0.5)) / 72);
  EXPECT_DOUBLE_EQ(cube.smallest_angle, pi / 4);
  EXPECT_DOUBLE_EQ(cube.largest_angle, pi / 2);
  EXPECT_TRUE(cube.warnings.empty());
}

TEST(MeshReport, WarnsOfSliversAndRepeatsTheWarningsOfTheMesh) {
  const MeshReport needles = report(testing::needle_cylinder());
  ASSERT_EQ(needles.warnings.size(), 1u);
  EXPECT_EQ(needles.warnings[0], "96 faces have an angle below 0.001 radians.");
  EXPECT_EQ(report(testing::slit_annulus()).warnings, testing::slit_annulus().warnings());
}

TEST(MeshReport, LeavesUnusedVerticesOut) {
  const TriangleMesh mesh = TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}}, {{0, 1, 2}});
  const MeshReport r = report(mesh);
  EXPECT_EQ(r.vertices, 4);
  EXPECT_EQ(r.genus, 0);
  EXPECT_EQ(r.upper, Eigen::Vector3d(1, 1, 0));
}

TEST(MeshReport, OfAnEmptyMeshIsZero) {
  const MeshReport r = report(TriangleMesh());
  EXPECT_EQ(r.faces, 0);
  EXPECT_EQ(r.area, 0);
  EXPECT_EQ(r.edge_max, 0);
}

}  // namespace
}  // namespace supple::surface
