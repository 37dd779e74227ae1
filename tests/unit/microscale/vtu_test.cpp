#include "supple/microscale/vtu.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

/// A plus-shaped cell: material reaches all four sides of the patch.
tiling::PeriodicMesh plus() { return testing::draw({".#.", "###", ".#."}, {0.4, 0.3, 0.5}, {0.2, 0.3, 0.6}); }

DeformedMesh homogeneous(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2d& f) {
  return {std::make_shared<const tiling::PeriodicMesh>(mesh), f * mesh.lattice, f * mesh.nodes};
}

std::vector<double> numbers_of(const std::string& vtu, const std::string& name) {
  const auto start = vtu.find('>', vtu.find("Name=\"" + name + "\""));
  std::istringstream text(vtu.substr(start + 1, vtu.find("</DataArray>", start) - start - 1));
  std::vector<double> numbers;
  for (double number = 0; text >> number;) numbers.push_back(number);
  return numbers;
}

TEST(UnwrappedMesh, HasNodesOfOppositeSidesTwiceAndAllTrianglesWhereTheyLieAtRest) {
  const auto mesh = plus();
  const auto unwrapped = unwrap(mesh);
  EXPECT_EQ(static_cast<Eigen::Index>(unwrapped.points.size()), mesh.nodes.cols() + 3 + 3);
  const auto at = positions(unwrapped, mesh.lattice, mesh.nodes);
  ASSERT_EQ(unwrapped.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 6; ++k) {
      const int point = unwrapped.triangles[t][static_cast<std::size_t>(k)];
      EXPECT_EQ(Eigen::Vector2d(at.col(point)), mesh.corner(static_cast<int>(t), k));
    }
  }
}

TEST(UnwrappedMesh, HasOneRowForEachPointAndForTheCornersOfEachTriangle) {
  const auto mesh = plus();
  const auto unwrapped = unwrap(mesh);
  const Eigen::MatrixXd vertices = vertices_of(unwrapped, mesh.lattice, mesh.nodes);
  const Eigen::MatrixXi faces = faces_of(unwrapped);
  EXPECT_EQ(vertices, positions(unwrapped, mesh.lattice, mesh.nodes).transpose());
  ASSERT_EQ(faces.rows(), static_cast<Eigen::Index>(mesh.triangles.size()));
  for (int t = 0; t < faces.rows(); ++t)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(Eigen::Vector2d(vertices.row(faces(t, k)).transpose()), mesh.corner(t, k));
}

TEST(UnwrappedMesh, FollowsTheDeformedTranslations) {
  const auto mesh = plus();
  const Eigen::Matrix2d f = (Eigen::Matrix2d() << 1.2, 0.3, -0.1, 0.9).finished();
  const auto unwrapped = unwrap(mesh);
  const auto deformed = homogeneous(mesh, f);
  const Eigen::Matrix2Xd expected = f * positions(unwrapped, mesh.lattice, mesh.nodes);
  EXPECT_TRUE(positions(unwrapped, deformed.lattice, deformed.nodes).isApprox(expected, 1e-14));
}

TEST(Vtu, HasEveryPointTriangleAndNumber) {
  const auto mesh = plus();
  const auto unwrapped = unwrap(mesh);
  const Eigen::Matrix2d f = (Eigen::Matrix2d() << 1.1, 0.2, 0, 0.95).finished();
  const auto vtu = write_vtu(unwrapped, homogeneous(mesh, f), {});
  const auto points = numbers_of(vtu, "Points");
  const auto displacement = numbers_of(vtu, "displacement");
  ASSERT_EQ(points.size(), 3 * unwrapped.points.size());
  ASSERT_EQ(displacement.size(), points.size());
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const Eigen::Vector2d rest(points[i], points[i + 1]);
    const Eigen::Vector2d moved(displacement[i], displacement[i + 1]);
    EXPECT_TRUE((rest + moved).isApprox(f * rest, 1e-13) || rest.norm() < 1e-13);
    EXPECT_EQ(displacement[i + 2], 0);
  }
  EXPECT_EQ(numbers_of(vtu, "connectivity").size(), 6 * mesh.triangles.size());
  EXPECT_EQ(numbers_of(vtu, "offsets").back(), 6.0 * static_cast<double>(mesh.triangles.size()));
  EXPECT_EQ(numbers_of(vtu, "types"), std::vector<double>(mesh.triangles.size(), 22));
}

TEST(Vtu, HasTheEnergyDensityOfAHomogeneousDeformationInEveryTriangle) {
  const auto mesh = plus();
  const Eigen::Matrix2d f = (Eigen::Matrix2d() << 1.1, 0.2, 0.1, 0.9).finished();
  const double j = f.determinant();
  const Material soft{Law::neo_hookean, 26, 0.48};
  const Material sheet{Law::incompressible_plane_stress, 26, 0.5};
  const double mu = 26 / (2 * 1.48);
  const double lambda = 26 * 0.48 / (1.48 * 0.04);
  const double neo_hookean = mu / 2 * (f.squaredNorm() - 2 - 2 * std::log(j)) + lambda / 2 * std::log(j) * std::log(j);
  const double plane_stress = 26.0 / 6 * (f.squaredNorm() + 1 / (j * j) - 3);
  for (const auto& [material, expected] : {std::pair{soft, neo_hookean}, std::pair{sheet, plane_stress}}) {
    const auto energies = numbers_of(write_vtu(unwrap(mesh), homogeneous(mesh, f), material), "energy_density");
    ASSERT_EQ(energies.size(), mesh.triangles.size());
    for (const double energy : energies) EXPECT_NEAR(energy, expected, 1e-10 * expected);
  }
}

TEST(Vtu, HasNoEnergyAtRest) {
  const auto mesh = plus();
  const auto vtu = write_vtu(unwrap(mesh), homogeneous(mesh, Eigen::Matrix2d::Identity()), {});
  for (const double energy : numbers_of(vtu, "energy_density")) EXPECT_NEAR(energy, 0, 1e-12);
}

}  // namespace
}  // namespace supple::microscale
