#include "supple/tiling/helper_tasks.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "designs.h"
#include "file_makers.h"
#include "supple/base/error.h"
#include "support/expect_error.h"

namespace supple::tiling {
namespace {

using supple::testing::expect_error;

Structure preset(std::string_view id) {
  std::vector<double> parameters;
  for (const Parameter& parameter : family(id).parameters) parameters.push_back(parameter.preset);
  return make_structure(family(id), parameters);
}

class TilingInHelpers : public ::testing::Test {
 protected:
  TilingInHelpers() { use_helper_processes(std::make_shared<HelperProcesses>(HelperOptions{SUPPLE_HELPER, 2, 0})); }
  ~TilingInHelpers() override { use_helper_processes(nullptr); }
};

TEST_F(TilingInHelpers, GivesTheBitsOfMeshesMadeHere) {
  for (const auto& family : families()) {
    const Structure structure = preset(family.id);
    for (const Region region : {Region::automatic, Region::tile, Region::cell}) {
      const MeshOptions options{.mesh_size = 0.8, .region = region};
      const PeriodicMesh here = make_mesh(structure, options);
      const PeriodicMesh there = mesh_structure(structure, options);
      EXPECT_TRUE(testing::identical(here, there)) << family.id;
      EXPECT_EQ(here.outline.size(), there.outline.size());
      EXPECT_EQ(here.mesh_size, there.mesh_size);
      EXPECT_EQ(here.beam_width, there.beam_width);
      EXPECT_EQ(here.cells_first * here.cells_second, there.cells_first * there.cells_second);
    }
  }
}

TEST_F(TilingInHelpers, GivesTheBytesOfFilesMadeHere) {
  const Structure structure = preset("IH21");
  const ExportOptions options{.first = 9, .second = 8, .height = 2};
  EXPECT_EQ(write_svg(structure, options), make_svg(structure, options));
  EXPECT_EQ(write_dxf(structure, options), make_dxf(structure, options));
  EXPECT_EQ(write_stl(structure, options), make_stl(structure, options));
}

TEST_F(TilingInHelpers, ThrowsWhatIsThrownHere) {
  const auto option = expect_error("tiling.mesh_option", [] { mesh_structure(preset("IH21"), {.mesh_size = -1}); });
  EXPECT_EQ(supple::testing::places(option), std::vector<std::string>{"mesh_size"});
  const auto cells = expect_error("tiling.export_option", [] { write_dxf(preset("IH21"), {.first = 101}); });
  EXPECT_EQ(supple::testing::places(cells), std::vector<std::string>{"first"});
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
    expect_error("job.cancelled", [&] { write(structure, large, execution); });
    stopper.join();
  }
}

}  // namespace
}  // namespace supple::tiling
