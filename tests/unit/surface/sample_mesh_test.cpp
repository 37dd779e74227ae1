#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "supple/surface/mesh_io.h"
#include "supple/surface/mesh_report.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

TEST(SampleMesh, IsAClosedTrefoilKnotWithoutFaults) {
  std::ifstream file(SUPPLE_SAMPLE_MESHES "/trefoil-knot.obj", std::ios::binary);
  ASSERT_TRUE(file) << "api/examples/meshes/trefoil-knot.obj is missing";
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  EXPECT_LT(bytes.size(), 300'000u);
  const TriangleMesh mesh = load_mesh(bytes);
  const MeshReport r = report(mesh);
  EXPECT_EQ(r.faces, 3840);
  EXPECT_EQ(r.components, 1);
  EXPECT_EQ(r.boundary_loops, 0);
  EXPECT_EQ(r.genus, 1);
  EXPECT_TRUE(r.warnings.empty());
  // The same knot as the generated one, to the six decimals of the file.
  const TriangleMesh generated = testing::trefoil_knot();
  ASSERT_EQ(mesh.faces(), generated.faces());
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_LT((mesh.positions()[v] - generated.positions()[v]).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace supple::surface
