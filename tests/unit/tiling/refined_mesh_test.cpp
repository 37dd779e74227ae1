#include "supple/tiling/refined_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "designs.h"

namespace supple::tiling {
namespace {

using testing::expect_sound;
using testing::preset_structure;

TEST(RefinedMesh, IsAsSoundAsTheMeshForEveryFamily) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family.id);
    const Structure structure = preset_structure(family.id.c_str());
    const PeriodicMesh coarse = mesh_structure(structure, {.mesh_size = 0.8, .corner_size = 0.3});
    const RefinedMesh fine = refine(coarse);
    expect_sound(fine.mesh, structure);
    EXPECT_EQ(fine.mesh.triangles.size(), 4 * coarse.triangles.size());
    EXPECT_EQ(fine.mesh.outline.size(), 2 * coarse.outline.size());
    EXPECT_NEAR(statistics(fine.mesh).smallest_angle, statistics(coarse).smallest_angle, 1e-9);
    EXPECT_EQ(fine.mesh.nodes.leftCols(coarse.nodes.cols()), coarse.nodes);
  }
}

TEST(RefinedMesh, OfAPatchIsThePatchOfTheRefinedMesh) {
  const PeriodicMesh cell = mesh_structure(preset_structure("IH01"), {.mesh_size = 1, .corner_size = 0.5});
  const PeriodicMesh first = refine(repeat(cell, 2, 2)).mesh;
  const PeriodicMesh second = repeat(refine(cell).mesh, 2, 2);
  EXPECT_EQ(first.nodes.cols(), second.nodes.cols());
  EXPECT_NEAR(first.solid_area(), second.solid_area(), 1e-9 * second.solid_area());
}

TEST(RefinedMesh, EveryTriangleSeesTheQuadraticFieldOfItsParent) {
  const PeriodicMesh cell = mesh_structure(preset_structure("IH01"), {.mesh_size = 1, .corner_size = 0.5});
  const RefinedMesh fine = refine(cell);
  // Any values at the nodes define a quadratic field in each triangle.
  Eigen::Matrix2Xd values(2, cell.nodes.cols());
  for (Eigen::Index i = 0; i < values.cols(); ++i) values.col(i) << std::sin(3.7 * static_cast<double>(i)), i % 5;
  const Eigen::Matrix2Xd prolonged = fine.prolong(values);
  for (std::size_t t = 0; t < fine.mesh.triangles.size(); ++t) {
    const auto parent = static_cast<int>(t / 4);
    const Eigen::Vector2d a = cell.corner(parent, 0);
    Eigen::Matrix2d sides;
    sides << cell.corner(parent, 1) - a, cell.corner(parent, 2) - a;
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector2d at = sides.inverse() * (fine.mesh.corner(static_cast<int>(t), k) - a);
      const Eigen::Vector3d b(1 - at.sum(), at[0], at[1]);
      const double shape[6] = {b[0] * (2 * b[0] - 1), b[1] * (2 * b[1] - 1), b[2] * (2 * b[2] - 1),
                               4 * b[0] * b[1],       4 * b[1] * b[2],       4 * b[2] * b[0]};
      Eigen::Vector2d expected = Eigen::Vector2d::Zero();
      for (std::size_t j = 0; j < 6; ++j)
        expected += shape[j] * values.col(cell.triangles[static_cast<std::size_t>(parent)][j]);
      const Eigen::Vector2d seen = prolonged.col(fine.mesh.triangles[t][static_cast<std::size_t>(k)]);
      ASSERT_LT((seen - expected).norm(), 1e-6) << "triangle " << t << ", node " << k;
    }
  }
}

}  // namespace
}  // namespace supple::tiling
