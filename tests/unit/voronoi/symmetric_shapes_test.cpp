// Sites that a symmetry of the surface maps onto each other: borders run along edges, through vertices and along the
// diagonals of faces, where all that tells one site from the other is rounding.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

#include "supple/voronoi/diagram.h"
#include "support/shapes.h"
#include "support/symmetric_shapes.h"
#include "support/valid_diagram.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

Diagram diagram_at_vertices(const TriangleMesh& mesh, const std::vector<int>& vertices) {
  std::vector<SurfacePoint> sites;
  for (const int v : vertices) sites.push_back(vertex_point(mesh, VertexId(v)));
  return diagram(GeodesicSolver(testing::share(mesh)), sites);
}

TEST(SymmetricShapes, OppositeSitesOfAnExportedRingHaveHalfOfItEach) {
  const TriangleMesh mesh = testing::exported_ring();
  const Diagram found = diagram_at_vertices(mesh, {0, 16});
  testing::expect_valid_diagram(mesh, found);
  const double half = 0.5 * testing::area_of(mesh);
  for (const DiagramCell& cell : found.cells) {
    EXPECT_NEAR(cell.area, half, 1e-9 * half);
    EXPECT_EQ(cell.boundary.size(), 2U) << "a piece of tube ends twice";
  }
  EXPECT_EQ(found.edges.size(), 2U);
  EXPECT_TRUE(found.vertices.empty());
}

}  // namespace
}  // namespace supple::voronoi
