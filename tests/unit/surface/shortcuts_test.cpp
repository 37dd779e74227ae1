#include "supple/surface/shortcuts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "supple/surface/mesh_io.h"
#include "support/expect_error.h"
#include "support/sampling.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace supple::surface {
namespace {

using testing::expect_error;

TEST(Matrices, OfAMeshGiveTheMeshBack) {
  const TriangleMesh mesh = testing::torus(12, 8);
  const TriangleMesh again = mesh_of(vertices_of(mesh), faces_of(mesh));
  EXPECT_EQ(again.positions(), mesh.positions());
  EXPECT_EQ(again.faces(), mesh.faces());
}

TEST(Matrices, ThatAreNoMeshAreRefused) {
  const TriangleMesh mesh = testing::torus(12, 8);
  EXPECT_THROW(mesh_of(vertices_of(mesh).transpose(), faces_of(mesh)), std::invalid_argument);
  EXPECT_THROW(mesh_of(vertices_of(mesh), faces_of(mesh).leftCols<2>()), std::invalid_argument);
  expect_error("mesh.index_out_of_range", [&] { mesh_of(vertices_of(mesh).topRows(3), faces_of(mesh)); });
}

TEST(Matrices, HaveOneRowForEachPoint) {
  const TriangleMesh mesh = testing::torus(24, 12);
  RandomStream stream("matrices", 1);
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 20; ++i) points.push_back(testing::random_point(mesh, stream));
  const Eigen::MatrixXd at = positions(mesh, points);
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(Eigen::Vector3d(at.row(i).transpose()), position(mesh, points[static_cast<std::size_t>(i)]));
  EXPECT_LT((positions(mesh, nearest_points(mesh, at)) - at).cwiseAbs().maxCoeff(), 1e-14);

  const Eigen::MatrixXd nowhere = Eigen::MatrixXd::Constant(1, 3, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(nearest_points(mesh, nowhere), std::invalid_argument);
}

TEST(Shortcuts, AnswerWhatTheSolverAnswers) {
  const TriangleMesh mesh = testing::torus(24, 12);
  const GeodesicSolver solver(testing::share(mesh));
  const std::vector<int> vertices{0, 17, 100};
  const std::vector<SurfacePoint> points = vertex_points(mesh, vertices);
  const Eigen::MatrixXd v = vertices_of(mesh);
  const Eigen::MatrixXi f = faces_of(mesh);

  const double distance = solver.distance(points[0], points[1]);
  EXPECT_EQ(geodesic_distance(mesh, points[0], points[1]), distance);
  EXPECT_EQ(geodesic_distance(v, f, 0, 17), distance);
  const Geodesic path = shortest_path(mesh, points[0], points[1]);
  const Eigen::MatrixXd along = positions(path.path);
  EXPECT_NEAR((along.bottomRows(along.rows() - 1) - along.topRows(along.rows() - 1)).rowwise().norm().sum(), distance,
              1e-12);

  const GeodesicField field = solver.field(points);
  const Eigen::VectorXd distances = distances_from(v, f, vertices);
  ASSERT_EQ(distances.size(), mesh.vertex_count());
  for (Eigen::Index i = 0; i < distances.size(); ++i)
    EXPECT_EQ(distances[i], field.vertex_distances()[static_cast<std::size_t>(i)]);

  KarcherProblem problem;
  problem.points = points;
  EXPECT_EQ(karcher_mean(v, f, vertices).position, karcher_mean(solver, problem).position);
}

TEST(Shortcuts, RefusePointsThatTheMeshDoesNotHave) {
  const TriangleMesh mesh = testing::torus(12, 8);
  const SurfacePoint inside{FaceId{0}, Eigen::Vector3d::Constant(1.0 / 3)};
  const SurfacePoint nowhere{FaceId{mesh.face_count()}, Eigen::Vector3d::Constant(1.0 / 3)};
  expect_error<PointError>("point.face_out_of_range", [&] { geodesic_distance(mesh, inside, nowhere); });
  expect_error<PointError>("point.face_out_of_range", [&] { shortest_path(mesh, nowhere, inside); });
  expect_error<PointError>("point.face_out_of_range", [&] { distances_from(mesh, {inside, nowhere}); });
  expect_error<PointError>("point.vertex_out_of_range",
                           [&] { geodesic_distance(vertices_of(mesh), faces_of(mesh), 0, -1); });
}

TEST(Shortcuts, SayThatNoPathJoinsTwoComponents) {
  const TriangleMesh mesh = testing::two_components();
  const Eigen::VectorXd distances = distances_from(mesh, vertex_points(mesh, {0}));
  EXPECT_EQ(distances[0], 0);
  EXPECT_TRUE(std::isinf(distances.maxCoeff()));
}

TEST(MeshFile, IsReadOrRefusedByItsName) {
  const testing::TemporaryFolder folder;
  const TriangleMesh mesh = testing::torus(12, 8);
  std::ofstream(folder / "torus.ply", std::ios::binary) << write_ply(mesh);
  EXPECT_EQ(load_mesh_file(folder / "torus.ply").positions(), mesh.positions());
  expect_error("file.unreadable", [&] { load_mesh_file(folder / "nothing.obj"); });
}

TEST(MeshFile, AFolderIsRefused) {
  const testing::TemporaryFolder folder;
  expect_error("file.unreadable", [&] { load_mesh_file(folder.path()); });
}

}  // namespace
}  // namespace supple::surface
