#include "supple/tiling/helper_tasks.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "designs.h"
#include "file_makers.h"
#include "part_tasks.h"
#include "supple/base/error.h"
#include "supple/tiling/tiling_error.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_cancelled;
using supple::testing::expect_error;

Structure preset(std::string_view id) { return make_structure(family(id), presets(family(id))); }

class TilingInHelpers : public ::testing::Test {
 protected:
  TilingInHelpers() { use_helper_processes(std::make_shared<HelperProcesses>(HelperOptions{SUPPLE_HELPER, 2, 0})); }
  ~TilingInHelpers() override { use_helper_processes(nullptr); }
};

TEST_F(TilingInHelpers, GivesTheBitsOfAMeshWhateverWasMeshedBeforeAndMostlyOfOneMadeHere) {
  int meshes = 0, others = 0;
  std::vector<std::pair<Structure, MeshOptions>> asked;
  std::vector<PeriodicMesh> answers;
  for (const auto& family : families()) {
    const Structure structure = preset(family.id);
    for (const Region region : {Region::automatic, Region::tile, Region::cell}) {
      const MeshOptions options{.mesh_size = 0.8, .region = region};
      const PeriodicMesh here = make_mesh(structure, options);
      const PeriodicMesh there = mesh_structure(structure, options);
      // gmsh orders triangles of equal size by their addresses in memory, which differ between processes.
      others += testing::identical(here, there) ? 0 : 1;
      ++meshes;
      testing::expect_sound(there, structure);
      EXPECT_EQ(here.mesh_size, there.mesh_size);
      EXPECT_EQ(here.beam_width, there.beam_width);
      EXPECT_EQ(here.cells_first * here.cells_second, there.cells_first * there.cells_second);
      asked.emplace_back(structure, options);
      answers.push_back(there);
    }
  }
  EXPECT_LE(others, meshes / 8) << "of " << meshes;
  // The meshes are made again by the same helper in another order, then each by a new helper.
  for (std::size_t k = asked.size(); k-- > 0;)
    EXPECT_TRUE(testing::identical(mesh_structure(asked[k].first, asked[k].second), answers[k])) << k;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    use_helper_processes(std::make_shared<HelperProcesses>(HelperOptions{SUPPLE_HELPER, 1, 0}));
    EXPECT_TRUE(testing::identical(mesh_structure(asked[k].first, asked[k].second), answers[k])) << k;
  }
}

TEST_F(TilingInHelpers, GivesTheBytesOfFilesMadeHere) {
  const Structure structure = preset("IH21");
  const ExportOptions options{.first = 9, .second = 8, .height = 2};
  EXPECT_EQ(write_svg(structure, options), make_svg(structure, options));
  EXPECT_EQ(write_dxf(structure, options), make_dxf(structure, options));
  EXPECT_EQ(write_stl(structure, options), make_stl(structure, options));
}

TEST_F(TilingInHelpers, GivesThePartsMadeHere) {
  PartDesign design;
  design.outline = {{{0, 0}, {60, 0}, {60, 40}, {0, 40}}};
  design.filling = {preset("IH21"), 0.4, 0.2};
  design.regions.push_back({{{0, 0}, {20, 0}, {20, 40}, {0, 40}}, {preset("IH50"), 0.3, 0}});
  design.solids = {{{0, 0}, {60, 0}, {60, 3}, {0, 3}}};
  design.frame = 0.5;
  design.seam = 0.3;
  design.thickness = 2;
  design.divides_solid = true;
  const Part there = make_part(design), here = make_part_here(design);
  EXPECT_EQ(there.faces, here.faces);
  EXPECT_EQ(there.lower, here.lower);
  EXPECT_EQ(there.upper, here.upper);
  EXPECT_EQ(there.outline_area, here.outline_area);
  EXPECT_EQ(there.solid_area, here.solid_area);
  EXPECT_EQ(there.trimmed_area, here.trimmed_area);
  EXPECT_EQ(there.crumbs, here.crumbs);
  EXPECT_EQ(there.crumb_area, here.crumb_area);
  EXPECT_EQ(there.widened_necks, here.widened_necks);
  EXPECT_EQ(there.cut_necks, here.cut_necks);
  EXPECT_EQ(there.left_necks, here.left_necks);
  EXPECT_TRUE(there.smallest_neck.has_value());
  EXPECT_EQ(there.smallest_neck, here.smallest_neck);
  EXPECT_EQ(there.thickness, 2);
  ASSERT_EQ(there.regions.size(), here.regions.size());
  ASSERT_GT(there.regions.size(), 1U);
  for (std::size_t i = 0; i < here.regions.size(); ++i) {
    EXPECT_EQ(there.regions[i].name, here.regions[i].name);
    EXPECT_EQ(there.regions[i].faces, here.regions[i].faces);
  }
  const std::string stl = part_stl(there), package = part_3mf(there);
  use_helper_processes(nullptr);
  EXPECT_EQ(part_stl(here), stl);
  EXPECT_EQ(part_3mf(here), package);
}

TEST_F(TilingInHelpers, EndsAPartWhereAStopIsRequested) {
  PartDesign design;
  design.outline = {{{0, 0}, {300, 0}, {300, 300}, {0, 300}}};
  design.filling.structure = preset("IH21");
  Execution execution;
  std::thread stopper([&execution] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    execution.cancellation.request(StopReason::cancelled);
  });
  expect_cancelled(StopReason::cancelled, [&] { make_part(design, execution); });
  stopper.join();
}

TEST_F(TilingInHelpers, ThrowsWhatIsThrownHere) {
  const auto option =
      expect_error<MeshOptionError>("tiling.mesh_option", [] { mesh_structure(preset("IH21"), {.mesh_size = -1}); });
  EXPECT_EQ(supple::testing::places(option), std::vector<std::string>{"mesh_size"});
  const auto cells =
      expect_error<TilingError>("tiling.export_option", [] { write_dxf(preset("IH21"), {.first = 101}); });
  EXPECT_EQ(supple::testing::places(cells), std::vector<std::string>{"first"});
}

TEST_F(TilingInHelpers, GivesErrorsTheTypesThatTheyHaveHere) {
  expect_error<MeshTooLarge>("tiling.mesh_too_large",
                             [] { mesh_structure(preset("IH21"), {.mesh_size = 0.8, .max_nodes = 10}); });
  PartDesign design;
  design.outline = {{{0, 0}, {60, 0}, {60, 40}, {0, 40}}};
  design.filling = {preset("IH21"), 0.005, 0};
  expect_error<PartError>("tiling.part", [&] { make_part(design); });
}

TEST_F(TilingInHelpers, EndsWhereAStopIsRequested) {
  const Structure structure = preset("IH21");
  const ExportOptions large{.first = 100, .second = 100};
  for (const auto write : {write_svg, write_dxf, write_stl}) {
    Execution execution;
    std::thread stopper([&execution] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      execution.cancellation.request(StopReason::cancelled);
    });
    expect_cancelled(StopReason::cancelled, [&] { write(structure, large, execution); });
    stopper.join();
  }
}

}  // namespace
}  // namespace supple::tiling
