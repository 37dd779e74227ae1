// STEP files of parts, read back by the CAD kernel that gmsh has.
#include <gmsh.h>
#include <gtest/gtest.h>

#include <fstream>

#include "designs.h"
#include "supple/base/error.h"
#include "supple/tiling/part.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_cancelled;
using supple::testing::expect_error;
using supple::testing::places;
using testing::preset_structure;

/// Properties of a file's solid according to a CAD kernel.
struct StepSolid {
  std::size_t solids = 0, faces = 0;
  double volume = 0;
  Eigen::Vector3d lower, upper;
};

StepSolid read_back(const std::string& step) {
  const supple::testing::TemporaryFolder folder;
  const auto path = folder / "part.step";
  std::ofstream(path, std::ios::binary) << step;
  gmsh::initialize(0, nullptr, false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::model::add("step");
  gmsh::vectorpair entities, volumes, faces;
  gmsh::model::occ::importShapes(path.string(), entities);
  gmsh::model::occ::synchronize();
  gmsh::model::getEntities(volumes, 3);
  gmsh::model::getEntities(faces, 2);
  StepSolid solid{volumes.size(), faces.size(), 0, {}, {}};
  for (const auto& [dimension, tag] : volumes) {
    double volume = 0;
    gmsh::model::occ::getMass(dimension, tag, volume);
    solid.volume += volume;
  }
  gmsh::model::getBoundingBox(-1, -1, solid.lower[0], solid.lower[1], solid.lower[2], solid.upper[0], solid.upper[1],
                              solid.upper[2]);
  gmsh::model::remove();
  return solid;
}

std::size_t step_corners(const Part& part) {
  std::size_t corners = 0;
  for (const SolidFace& face : part.faces) {
    for (const Polygon& polygon : face) corners += polygon.size();
  }
  return corners;
}

PartDesign step_plate(const char* name, double width, double height) {
  PartDesign design;
  design.outline = {{{0, 0}, {width, 0}, {width, height}, {0, height}}};
  design.filling.structure = preset_structure(name);
  return design;
}

TEST(PartStep, IsTheSolidThatACadKernelReads) {
  for (const char* name : {"IH01", "IH21", "IH50"}) {
    SCOPED_TRACE(name);
    PartDesign design = step_plate(name, 14, 9);
    design.frame = 0.5;
    design.thickness = 2.5;
    const Part part = make_part(design);
    const StepSolid solid = read_back(part_step(part));
    EXPECT_EQ(solid.solids, 1U);
    EXPECT_EQ(solid.faces, step_corners(part) + 2) << "a wall for each side, a top and a bottom";
    EXPECT_NEAR(solid.volume, 2.5 * part.solid_area, 1e-9 * solid.volume) << "positive: its faces point outwards";
    // gmsh widens the box by the tolerance of the shape.
    EXPECT_NEAR((solid.lower - Eigen::Vector3d(0, 0, 0)).norm(), 0, 1e-5);
    EXPECT_NEAR((solid.upper - Eigen::Vector3d(14, 9, 2.5)).norm(), 0, 1e-5);
  }
}

TEST(PartStep, HasTheHolesAndTheSlantsOfItsOutline) {
  PartDesign design = step_plate("IH67", 20, 20);
  design.outline = {{{-3, -1000}, {17, -1002}, {14, -985}, {-1, -987}}, {{4, -997}, {9, -998}, {8, -992}}};
  design.frame = 1;
  design.filling.orientation = 0.3;
  const Part part = make_part(design);
  ASSERT_GT(part.faces[0].size(), 2U);
  const StepSolid solid = read_back(part_step(part));
  EXPECT_EQ(solid.solids, 1U);
  EXPECT_NEAR(solid.volume, part.solid_area, 1e-8 * solid.volume);
}

TEST(PartStep, IsTheSameAgainAndNamed) {
  const Part part = make_part(step_plate("IH21", 15, 10));
  const std::string step = part_step(part);
  EXPECT_EQ(part_step(part), step);
  EXPECT_TRUE(step.starts_with("ISO-10303-21;\n"));
  EXPECT_NE(step.find("PRODUCT('Supple part, 15 x 10 x 1 mm'"), std::string::npos);
}

TEST(PartStep, RefusesMoreCornersThanACadProgramTakes) {
  Part part = make_part(step_plate("IH21", 15, 10));
  part.faces[0][0].resize(50'001, Eigen::Vector2d(1, 1));
  const Error error = expect_error<PartError>("tiling.part", [&] { part_step(part); });
  EXPECT_EQ(places(error), decltype(places(error)){"beam_width"});
  EXPECT_NE(std::string(error.what()).find("at most 50000"), std::string::npos);
}

TEST(PartStep, StopsWhenAsked) {
  Part part = make_part(step_plate("IH21", 15, 10));
  part.faces[0][0].resize(5'000, Eigen::Vector2d(1, 1));
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { part_step(part, execution); });
}

}  // namespace
}  // namespace supple::tiling
