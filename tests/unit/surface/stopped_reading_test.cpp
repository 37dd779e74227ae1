#include <gtest/gtest.h>

#include "supple/base/error.h"
#include "supple/surface/mesh_io.h"
#include "supple/surface/mesh_repair.h"
#include "supple/surface/mesh_report.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_cancelled;
using testing::expect_error;

/// A grid of 2 * 200 * 200 faces: more than are read between two looks for a stop.
TriangleMesh large_mesh() { return testing::flat_grid(200, 200); }

class StoppedReading : public ::testing::Test {
 protected:
  StoppedReading() { stopped_.cancellation.request(StopReason::cancelled); }
  Execution stopped_;
};

TEST_F(StoppedReading, OfEveryFormatEndsWithTheStop) {
  const TriangleMesh mesh = large_mesh();
  const std::string obj = write_obj(mesh);
  const std::string ply = write_ply(mesh);
  std::string off = "OFF\n" + std::to_string(mesh.vertex_count()) + " " + std::to_string(mesh.face_count()) + " 0\n";
  for (const auto& p : mesh.positions())
    off += std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
  for (const auto& f : mesh.faces())
    off += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) + "\n";
  std::string stl = "solid\n";
  for (const auto& f : mesh.faces()) {
    stl += "facet normal 0 0 1\nouter loop\n";
    for (const auto v : f) {
      const auto& p = mesh.positions()[static_cast<std::size_t>(v)];
      stl += "vertex " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
    }
    stl += "endloop\nendfacet\n";
  }
  stl += "endsolid\n";
  for (const std::string& bytes : {obj, ply, off, stl}) {
    EXPECT_EQ(load_mesh(bytes).face_count(), mesh.face_count());
    expect_cancelled(StopReason::cancelled, [&] { read_mesh(bytes, detect_format(bytes), {}, stopped_); });
  }
}

TEST_F(StoppedReading, AndBuildingReportingWritingAndRepairingToo) {
  const TriangleMesh mesh = large_mesh();
  expect_cancelled(StopReason::cancelled, [&] { TriangleMesh::build(mesh.positions(), mesh.faces(), {}, stopped_); });
  expect_cancelled(StopReason::cancelled, [&] { report(mesh, stopped_); });
  expect_cancelled(StopReason::cancelled, [&] { write_obj(mesh, stopped_); });
  expect_cancelled(StopReason::cancelled, [&] { write_ply(mesh, stopped_); });
  TriangleSoup soup{mesh.positions(), mesh.faces(), {}};
  RepairOptions options;
  options.ask(Repair::weld);
  expect_cancelled(StopReason::cancelled, [&] { repair_mesh(soup, options, {}, stopped_); });
}

}  // namespace
}  // namespace supple::surface
