#include "supple/tiling/mesh.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "designs.h"
#include "polygon.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;
using supple::testing::places;
using testing::expect_sound;
using testing::identical;
using testing::preset_structure;

TEST(Mesh, EveryFamilysDefaultCellIsSoundByTilesAndByCells) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family.id);
    const Structure structure = preset_structure(family.id.c_str());
    for (const Region region : {Region::tile, Region::cell}) {
      const PeriodicMesh mesh = mesh_structure(structure, {.mesh_size = 0.6, .corner_size = 1, .region = region});
      expect_sound(mesh, structure);
      EXPECT_GT(statistics(mesh).smallest_angle, 0.4);
      EXPECT_EQ(mesh.cells_first, 1);
      EXPECT_EQ(mesh.cells_second, 1);
      EXPECT_EQ(mesh.beam_width, structure.beam_width);
      EXPECT_DOUBLE_EQ(mesh.mesh_size, 0.6 * structure.beam_width);
    }
  }
}

TEST(Mesh, SidesHaveTheWantedLength) {
  const Structure structure = preset_structure("IH01");
  for (const Region region : {Region::tile, Region::cell}) {
    for (const double size : {1.0 / 3, 1.0 / 6}) {
      const MeshStatistics found =
          statistics(mesh_structure(structure, {.mesh_size = size, .corner_size = 1, .region = region}));
      EXPECT_LT(found.longest_side, 1.6 * size * structure.beam_width);
      EXPECT_GT(found.shortest_side, 0.4 * size * structure.beam_width);
    }
  }
}

TEST(Mesh, CornersAreGradedWithinHalfABeamWidth) {
  const Structure structure = preset_structure("IH22");
  const MeshOptions options = {.mesh_size = 0.5, .corner_size = 0.2};
  const double h = options.mesh_size * structure.beam_width;
  for (const Region region : {Region::tile, Region::cell}) {
    MeshOptions by_region = options;
    by_region.region = region;
    const PeriodicMesh mesh = mesh_structure(structure, by_region);
    expect_sound(mesh, structure);
    for (const auto& [triangle, side] : mesh.outline) {
      const Eigen::Vector2d a = mesh.corner(triangle, side), b = mesh.corner(triangle, (side + 1) % 3);
      double distance = std::numeric_limits<double>::infinity();
      for (const std::vector<Polygon>& holes : structure.holes) {
        for (const Eigen::Vector2d& corner : holes[0]) {
          const Eigen::Vector2d apart = corner - (a + b) / 2;
          const Eigen::Vector2d shift = (mesh.lattice.inverse() * apart).array().round();
          // The lattice is skewed, so that neighbours of the rounded shift are tried, too.
          for (int i = -1; i <= 1; ++i) {
            for (int j = -1; j <= 1; ++j) {
              distance = std::min(distance, (apart - mesh.lattice * (shift + Eigen::Vector2d(i, j))).norm());
            }
          }
        }
      }
      const double wanted = h * (0.2 + 0.8 * std::min(1.0, distance / (structure.beam_width / 2)));
      EXPECT_LT((b - a).norm(), 1.1 * wanted);
      EXPECT_GT((b - a).norm(), 0.5 * wanted);
    }
    const int uniform = static_cast<int>(
        mesh_structure(structure, {.mesh_size = 0.5, .corner_size = 1, .region = region}).nodes.cols());
    EXPECT_GT(mesh.nodes.cols(), uniform);
    EXPECT_LT(mesh.nodes.cols(), 4 * uniform);
  }
}

TEST(Mesh, RotationsThatCarryTilesToTilesCarryTheMeshToItself) {
  const Structure structure = preset_structure("IH21");
  const PeriodicMesh mesh = mesh_structure(structure, {.mesh_size = 0.8, .region = Region::tile});
  const Placement& sixth = structure.tiling.placements[1];
  const Eigen::Matrix2d inverse = mesh.lattice.inverse();
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) {
    const Eigen::Vector2d image = sixth.linear * mesh.nodes.col(k) + sixth.offset;
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index j = 0; j < mesh.nodes.cols(); ++j) {
      const Eigen::Vector2d at = inverse * (image - mesh.nodes.col(j));
      least = std::min(least, (mesh.lattice * (at.array() - at.array().round()).matrix()).norm());
    }
    ASSERT_LT(least, 1e-6) << "node " << k;
  }
}

TEST(Mesh, IsTheSameOnEveryCall) {
  const Structure one = preset_structure("IH01"), other = preset_structure("IH67");
  for (const Region region : {Region::tile, Region::cell}) {
    const MeshOptions options = {.corner_size = 0.3, .region = region};
    const PeriodicMesh first = mesh_structure(one, options);
    mesh_structure(other, options);
    EXPECT_TRUE(identical(first, mesh_structure(one, options)));
  }
}

TEST(Mesh, ARepeatedMeshIsSoundAndKeepsItsNodesOrder) {
  for (const char* id : {"IH01", "IH22", "square"}) {
    const Structure structure = preset_structure(id);
    const PeriodicMesh cell = mesh_structure(structure, {.mesh_size = 0.8});
    for (const auto& [first, second] : {std::pair(2, 2), std::pair(3, 1), std::pair(1, 2), std::pair(1, 1)}) {
      SCOPED_TRACE(std::string(id) + " " + std::to_string(first) + " x " + std::to_string(second));
      const PeriodicMesh patch = repeat(cell, first, second);
      EXPECT_EQ(patch.cells_first, first);
      EXPECT_EQ(patch.cells_second, second);
      const Eigen::Index n = cell.nodes.cols();
      ASSERT_EQ(patch.nodes.cols(), n * first * second);
      for (int b = 0; b < second; ++b) {
        for (int a = 0; a < first; ++a) {
          const auto copy = patch.nodes.middleCols(n * (a + first * b), n);
          const Eigen::Vector2d by = cell.lattice * Eigen::Vector2d(a, b);
          EXPECT_LT((copy - (cell.nodes.colwise() + by)).cwiseAbs().maxCoeff(), 1e-12);
        }
      }
      // The same patch is a structure of its own: a larger cell with copies of the tiles.
      Structure larger = structure;
      larger.tiling.lattice = patch.lattice;
      larger.tiling.placements.clear();
      larger.holes.clear();
      for (int b = 0; b < second; ++b) {
        for (int a = 0; a < first; ++a) {
          const Eigen::Vector2d by = cell.lattice * Eigen::Vector2d(a, b);
          for (Placement placement : structure.tiling.placements) {
            placement.offset += by;
            larger.tiling.placements.push_back(placement);
          }
          for (std::vector<Polygon> holes : structure.holes) {
            for (Polygon& hole : holes) hole = placed(hole, {.tile = 0, .offset = by});
            larger.holes.push_back(std::move(holes));
          }
        }
      }
      larger.cell_area *= first * second;
      larger.solid_area *= first * second;
      expect_sound(patch, larger);
    }
    EXPECT_TRUE(identical(repeat(cell, 1, 1), cell));
    const PeriodicMesh twice = repeat(repeat(cell, 2, 1), 1, 3), once = repeat(cell, 2, 3);
    EXPECT_EQ(twice.triangles, once.triangles);
    EXPECT_EQ(twice.shifts, once.shifts);
    EXPECT_LT((twice.nodes - once.nodes).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Mesh, APatchHasAtLeastOneCell) {
  const PeriodicMesh cell = mesh_structure(preset_structure("IH01"), {.mesh_size = 1});
  expect_error<MeshOptionError>("tiling.mesh_option", [&] { repeat(cell, 0, 2); });
  expect_error<MeshOptionError>("tiling.mesh_option", [&] { repeat(cell, 1, 101); });
}

TEST(Mesh, StatisticsDescribeTheMesh) {
  const Structure structure = preset_structure("IH01");
  const PeriodicMesh mesh = mesh_structure(structure);
  const MeshStatistics found = statistics(mesh);
  EXPECT_EQ(found.nodes, mesh.nodes.cols());
  EXPECT_EQ(found.triangles, static_cast<int>(mesh.triangles.size()));
  EXPECT_NEAR(found.relative_density, structure.solid_area / structure.cell_area, 1e-6);
  EXPECT_GT(found.smallest_angle, 0.3);
  EXPECT_LT(found.smallest_angle, 1.0472);  // the angle of equilateral triangles
  EXPECT_LT(found.shortest_side, found.longest_side);
}

TEST(Mesh, OptionsOutOfRangeAreNamed) {
  const Structure structure = preset_structure("IH01");
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const MeshOptions& options) {
    return places(expect_error<MeshOptionError>("tiling.mesh_option", [&] { mesh_structure(structure, options); }));
  };
  EXPECT_EQ(refused({.mesh_size = 0}), std::vector<std::string>{"mesh_size"});
  EXPECT_EQ(refused({.mesh_size = -1}), std::vector<std::string>{"mesh_size"});
  EXPECT_EQ(refused({.mesh_size = std::numeric_limits<double>::infinity()}), std::vector<std::string>{"mesh_size"});
  EXPECT_EQ(refused({.mesh_size = nan, .corner_size = nan}), (std::vector<std::string>{"mesh_size", "corner_size"}));
  EXPECT_EQ(refused({.corner_size = 0}), std::vector<std::string>{"corner_size"});
  EXPECT_EQ(refused({.corner_size = 1.5}), std::vector<std::string>{"corner_size"});
  EXPECT_EQ(refused({.max_nodes = 0}), std::vector<std::string>{"max_nodes"});
}

TEST(Mesh, MeshesTooLargeAreRefusedBeforeTheyAreMadeWithLimitAndEstimate) {
  const Structure structure = preset_structure("IH01");
  const Error error =
      expect_error<MeshTooLarge>("tiling.mesh_too_large", [&] { mesh_structure(structure, {.mesh_size = 1e-6}); });
  EXPECT_NE(std::string(error.what()).find("the limit is 2000000"), std::string::npos) << error.what();
  const int nodes = static_cast<int>(mesh_structure(structure).nodes.cols());
  expect_error<MeshTooLarge>("tiling.mesh_too_large", [&] { mesh_structure(structure, {.max_nodes = nodes / 2}); });
  EXPECT_NO_THROW(mesh_structure(structure, {.max_nodes = 2 * nodes}));
}

TEST(Mesh, TheEstimateOfNodesIsOfTheRightSize) {
  // The estimate differs from the true number by less than a factor of three.
  for (const double corner_size : {1.0, 0.2, 0.01}) {
    const Structure structure = preset_structure("IH28");
    MeshOptions options = {.mesh_size = 0.4, .corner_size = corner_size};
    const int nodes = static_cast<int>(mesh_structure(structure, options).nodes.cols());
    options.max_nodes = 3 * nodes;
    EXPECT_NO_THROW(mesh_structure(structure, options)) << corner_size;
    options.max_nodes = nodes / 3;
    const Error error =
        expect_error<MeshTooLarge>("tiling.mesh_too_large", [&] { mesh_structure(structure, options); });
    EXPECT_NE(std::string(error.what()).find("would have about"), std::string::npos) << error.what();
  }
}

TEST(Mesh, ThreadsThatMeshAtOnceGetWhatTheyGetAlone) {
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
