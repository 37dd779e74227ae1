#include "supple/embedded/shortcuts.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "supple/surface/matrices.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

TEST(SpringNetwork, HasASpringForEachRow) {
  const surface::TriangleMesh mesh = testing::torus(12, 8);
  const Eigen::MatrixXi pairs = (Eigen::MatrixXi(2, 2) << 0, 1, 1, 2).finished();
  const Network network = spring_network(surface::vertex_points(mesh, {0, 1, 2}), pairs, 0.25, {0}, 3);
  ASSERT_EQ(network.springs.size(), 2u);
  EXPECT_EQ(network.springs[1].from, 1);
  EXPECT_EQ(network.springs[1].to, 2);
  EXPECT_EQ(network.springs[1].rest_length, 0.25);
  EXPECT_EQ(network.springs[1].weight, 3);
  EXPECT_EQ(network.fixed_points, std::vector<std::int32_t>{0});
  EXPECT_THROW(spring_network({}, Eigen::MatrixXi::Zero(2, 3), 0), std::invalid_argument);
}

TEST(Relax, OfAMeshIsThatOfItsSolver) {
  const surface::TriangleMesh mesh = testing::flat_grid(4, 4);
  const Eigen::MatrixXi pairs = (Eigen::MatrixXi(2, 2) << 0, 1, 1, 2).finished();
  const Network network = spring_network(surface::vertex_points(mesh, {0, 7, 24}), pairs, 0, {0, 2});
  const Relaxation rest = relax(mesh, network);
  const Relaxation same = relax(surface::GeodesicSolver(testing::share(mesh)), network);
  EXPECT_EQ(positions(mesh, rest), surface::positions(mesh, same.points));
  // Two equal springs in the plane: the free point comes to rest halfway between the fixed ones.
  const Eigen::MatrixXd at = positions(mesh, rest);
  EXPECT_LT((at.row(1) - (at.row(0) + at.row(2)) / 2).norm(), 1e-9);
  EXPECT_EQ(host_vertices(mesh, rest), surface::vertices_of(mesh));
}

TEST(Positions, LieOnTheSurfaceThatMoved) {
  const surface::TriangleMesh mesh = testing::flat_grid(4, 4);
  const Eigen::MatrixXi pair = (Eigen::MatrixXi(1, 2) << 0, 1).finished();
  const Network network = spring_network(surface::vertex_points(mesh, {0, 24}), pair, 0, {0, 1});
  MovingHost host{{mesh.positions()}};
  for (Eigen::Vector3d& p : host.positions.front()) p.z() += 2;
  RelaxationOptions options;
  options.host = host;
  const Relaxation rest = relax(mesh, network, options);
  EXPECT_LT((positions(mesh, rest).col(2).array() - 2).abs().maxCoeff(), 1e-14);
  EXPECT_LT((host_vertices(mesh, rest).col(2).array() - 2).abs().maxCoeff(), 1e-14);
}

}  // namespace
}  // namespace supple::embedded
