#include "supple/meshing/helper_tasks.h"

#include <gtest/gtest.h>

#include "fill_here.h"
#include "supple/base/error.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::meshing {
namespace {

class FillingInHelpers : public ::testing::Test {
 protected:
  FillingInHelpers() { use_helper_processes(std::make_shared<HelperProcesses>(HelperOptions{SUPPLE_HELPER, 1, 0})); }
  ~FillingInHelpers() override { use_helper_processes(nullptr); }
};

TEST_F(FillingInHelpers, GivesTheBitsOfFillingHere) {
  const auto sphere = supple::testing::icosphere(2);
  const FillOptions options{.element_size = 0.3};
  const TetrahedralMesh here = fill_here(sphere.positions(), sphere.faces(), options, {});
  for (int round = 0; round < 2; ++round) {
    const TetrahedralMesh there = fill(sphere.positions(), sphere.faces(), options);
    EXPECT_EQ(there.nodes, here.nodes);
    EXPECT_EQ(there.tetrahedra, here.tetrahedra);
    EXPECT_EQ(there.surface_vertices, here.surface_vertices);
  }
}

TEST_F(FillingInHelpers, ThrowsWhatFillingHereThrows) {
  const auto sphere = supple::testing::icosphere(2);
  const auto error = supple::testing::expect_error("solid.too_many_elements", [&] {
    fill(sphere.positions(), sphere.faces(), {.element_size = 1e-3, .max_tetrahedra = 1000});
  });
  EXPECT_EQ(supple::testing::places(error), std::vector<std::string>{"element_size"});
  EXPECT_THROW(fill(sphere.positions(), sphere.faces(), {.element_size = -1}), std::invalid_argument);
}

TEST_F(FillingInHelpers, EndsWhereAStopIsRequested) {
  const auto sphere = supple::testing::icosphere(2);
  Execution stopped;
  stopped.cancellation.request(StopReason::cancelled);
  supple::testing::expect_cancelled(StopReason::cancelled,
                                    [&] { fill(sphere.positions(), sphere.faces(), {}, stopped); });
}

}  // namespace
}  // namespace supple::meshing
