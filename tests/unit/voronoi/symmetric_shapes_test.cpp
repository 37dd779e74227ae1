// Sites that a symmetry of the surface maps onto each other. Borders run along edges, through vertices and along
// diagonals of faces, where the distances of two sites differ by rounding only.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/base/random.h"
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

void expect_symmetric_diagram(const testing::SymmetricSites& drawn) {
  SCOPED_TRACE(drawn.name);
  const Diagram found = diagram(GeodesicSolver(testing::share(drawn.mesh)), drawn.sites);
  testing::expect_valid_diagram(drawn.mesh, found);
  const double whole = testing::area_of(drawn.mesh);
  for (std::size_t i = 0; i < found.cells.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (drawn.orbits[i] != drawn.orbits[j]) continue;
      EXPECT_NEAR(found.cells[i].area, found.cells[j].area, 1e-9 * whole) << "sites " << i << " and " << j;
    }
}

TEST(SymmetricShapes, HaveEqualCellsForEqualSites) {
  for (int family = 0; family < testing::symmetric_families; ++family) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      SCOPED_TRACE("family " + std::to_string(family) + ", seed " + std::to_string(seed));
      RandomStream stream("symmetric_sites", 1000 * static_cast<std::uint64_t>(family) + seed);
      expect_symmetric_diagram(testing::random_symmetric_sites(family, stream));
    }
  }
}

}  // namespace
}  // namespace supple::voronoi
