#include "supple/tiling/part_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "designs.h"
#include "supple/tiling/part.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

constexpr double tested_width = 0.3;  // mm

/// A block of a structure between solid plates.
Part block_of(const char* name, double side) {
  PartDesign design;
  const PartShape shape = compression_block(side, side, 1);
  design.outline = shape.outline;
  design.solids = shape.solids;
  design.filling = {testing::preset_structure(name), tested_width, 0};
  return make_part(design);
}

TEST(PartMesh, FillsTheSolidAndHasItsOutline) {
  const Part part = block_of("IH22", 20);
  ASSERT_GT(part.faces.at(0).size(), 3U) << "the part has no holes";
  const PeriodicMesh mesh = mesh_part(part.faces, tested_width);
  EXPECT_NEAR(mesh.solid_area(), part.solid_area, 1e-9 * part.solid_area);
  EXPECT_TRUE(std::ranges::all_of(mesh.shifts, [](const auto& shifts) {
    return std::ranges::all_of(shifts, [](const LatticeShift& shift) { return shift == LatticeShift{}; });
  })) << "a triangle crosses the border of the cell";
  double length = 0;
  for (const auto& [triangle, side] : mesh.outline)
    length += (mesh.corner(triangle, side) - mesh.corner(triangle, (side + 1) % 3)).norm();
  double expected = 0;
  for (const Polygon& polygon : part.faces[0])
    for (std::size_t k = 0; k < polygon.size(); ++k)
      expected += (polygon[k] - polygon[(k + 1) % polygon.size()]).norm();
  EXPECT_NEAR(length, expected, 1e-9 * expected);
  EXPECT_NEAR(mesh.lattice(0, 0), part_cell_ratio * (part.upper - part.lower).x(), 1e-9);
  EXPECT_GT(statistics(mesh).smallest_angle, 0.05);
}

TEST(PartMesh, IsEstimatedFromAboveBeforeItIsMade) {
  for (const double mesh_size : {1.0, 0.5}) {
    MeshOptions options;
    options.mesh_size = mesh_size;
    const Part part = block_of("IH01", 15);
    const PartMeshEstimate estimate = estimate_part_mesh(part.faces, tested_width, options);
    const auto nodes = static_cast<double>(mesh_part(part.faces, tested_width, options).nodes.cols());
    EXPECT_GE(estimate.nodes, nodes);
    EXPECT_LE(estimate.nodes, 4 * nodes);
    EXPECT_GT(estimate.bytes, 1000 * nodes);
  }
}

TEST(PartMesh, TooManyNodesAreRefusedBeforeMeshing) {
  const Part part = block_of("IH01", 15);
  MeshOptions options;
  options.max_nodes = 100;
  try {
    mesh_part(part.faces, tested_width, options);
    ADD_FAILURE() << "the mesh was not refused";
  } catch (const MeshTooLarge& error) {
    EXPECT_EQ(error.code(), "tiling.mesh_too_large");
    EXPECT_NE(std::string(error.what()).find("would have about"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("100"), std::string::npos) << error.what();
  }
}

TEST(PartMesh, IsFinerAtReentrantCorners) {
  MeshOptions graded;
  graded.corner_size = 0.2;
  MeshOptions uniform;
  uniform.corner_size = 1;
  const Part part = block_of("IH22", 10);
  EXPECT_GT(mesh_part(part.faces, tested_width, graded).nodes.cols(),
            mesh_part(part.faces, tested_width, uniform).nodes.cols());
}

}  // namespace
}  // namespace supple::tiling
