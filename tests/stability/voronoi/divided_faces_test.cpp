// An invariance as an oracle: the same surface with each face divided into four has the same cells, although no border
// is cut at the same places. A border that only one of the two diagrams has shows in the areas.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/random.h"
#include "supple/voronoi/diagram.h"
#include "support/shapes.h"
#include "support/symmetric_shapes.h"
#include "support/valid_diagram.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector3d;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Each face is divided into four: three at its corners, and one between the midpoints of its sides.
TriangleMesh divided(const TriangleMesh& mesh) {
  std::vector<Vector3d> positions = mesh.positions();
  std::vector<surface::Triangle> faces;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto [found, added] = middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(positions.size()));
    if (added)
      positions.emplace_back(0.5 * (positions[static_cast<std::size_t>(a)] + positions[static_cast<std::size_t>(b)]));
    return found->second;
  };
  for (const auto& [a, b, c] : mesh.faces()) {
    const std::int32_t ab = middle(a, b);
    const std::int32_t bc = middle(b, c);
    const std::int32_t ca = middle(c, a);
    faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return TriangleMesh::build(std::move(positions), std::move(faces));
}

SurfacePoint on_divided(const SurfacePoint& point) {
  const std::int32_t first = 4 * index(point.face);
  for (std::int32_t corner = 0; corner < 3; ++corner) {
    if (point.barycentric[corner] < 0.5) continue;
    Vector3d weights = 2 * point.barycentric;
    weights[corner] -= 1;
    return {FaceId(first + corner), weights};
  }
  const Vector3d& b = point.barycentric;
  return {FaceId(first + 3), {1 - 2 * b[2], 1 - 2 * b[0], 1 - 2 * b[1]}};
}

/// Expects the same cells with divided faces. `areas` and `lengths` are tolerances relative to the area of the surface
/// and to the length of all borders.
void expect_same_cells(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sites, double areas, double lengths) {
  std::vector<SurfacePoint> moved;
  for (const SurfacePoint& site : sites) moved.push_back(on_divided(site));
  const GeodesicSolver solver(testing::share(mesh));
  const Diagram whole = diagram(solver, sites);
  const Diagram parts = diagram(GeodesicSolver(testing::share(divided(mesh))), moved);
  const Diagram sampled = diagram(solver, sites, {.border_samples = true, .cell_moments = true});
  const double area = testing::area_of(mesh);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    EXPECT_NEAR(whole.cells[i].area, parts.cells[i].area, areas * area) << "site " << i;
    EXPECT_NEAR(whole.cells[i].area, sampled.cells[i].area, areas * area) << "site " << i << " when it is optimized";
  }
  const auto length = [](const Diagram& diagram) {
    double sum = 0;
    for (const DiagramEdge& edge : diagram.edges) sum += edge.length;
    return sum;
  };
  EXPECT_NEAR(length(whole), length(parts), lengths * length(parts));
}

TEST(DividedFaces, HaveTheCellsOfWholeOnes) {
  const std::vector<std::pair<std::string, TriangleMesh>> meshes{{"torus", testing::torus(24, 12)},
                                                                 {"trefoil knot", testing::trefoil_knot(80, 8)},
                                                                 {"bumpy cube", testing::bumpy_cube(8, 2.5, 0.1)},
                                                                 {"genus 3", testing::genus3(2)},
                                                                 {"rabbit", testing::rabbit(2)},
                                                                 {"saddle", testing::saddle(8)},
                                                                 {"L", testing::l_shape(3)},
                                                                 {"sphere", testing::icosphere(2)}};
  for (const auto& [name, mesh] : meshes) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      for (const int count : {3, 12}) {
        SCOPED_TRACE(name + ", " + std::to_string(count) + " sites, seed " + std::to_string(seed));
        const std::vector<SurfacePoint> sites = random_sites(mesh, count, seed);
        expect_same_cells(mesh, sites, 2e-7, 3e-5);
        expect_same_cells(mesh, testing::on_vertices_and_edges(sites), 2e-7, 3e-5);
      }
    }
  }
}

/// With these sites, paths from two images of one site are equally long in a whole region of a face. It was once halved
/// until memory ran out.
TEST(DividedFaces, HaveTheMomentsOfWholeOnesWhereTwoWaysAreAsLongAllOver) {
  const TriangleMesh mesh = testing::rabbit(3);
  const std::vector<SurfacePoint> sites = testing::on_vertices_and_edges(random_sites(mesh, 20, 1));
  std::vector<SurfacePoint> moved;
  for (const SurfacePoint& site : sites) moved.push_back(on_divided(site));
  const DiagramOptions options{.cell_moments = true};
  const Diagram whole = diagram(GeodesicSolver(testing::share(mesh)), sites, options);
  const Diagram parts = diagram(GeodesicSolver(testing::share(divided(mesh))), moved, options);
  double sum = 0;
  for (const CellMoments& moments : parts.cell_moments) sum += moments.squared_distance;
  for (std::size_t i = 0; i < sites.size(); ++i)
    EXPECT_NEAR(whole.cell_moments[i].squared_distance, parts.cell_moments[i].squared_distance, 1e-7 * sum)
        << "site " << i;
}

TEST(DividedFaces, HaveTheCellsOfWholeOnesNextToASymmetry) {
  for (int family = 0; family < testing::symmetric_families; ++family) {
    for (std::uint64_t draw = 0; draw < 6; ++draw) {
      const std::uint64_t seed = 1000 * static_cast<std::uint64_t>(family) + draw;
      RandomStream stream("divided_faces", seed);
      const testing::SymmetricSites sites =
          testing::disturbed(testing::random_symmetric_sites(family, stream), {.noise = 1e-4}, stream);
      SCOPED_TRACE("family " + std::to_string(family) + ", seed " + std::to_string(seed) + ", " + sites.name);
      expect_same_cells(sites.mesh, sites.sites, 2e-7, 3e-5);
    }
  }
}

/// Two sites of an octahedron that a rotation maps onto each other: noise changes their cells in proportion. In some of
/// these cases, bends that do not lie over the chord of their border were not found before.
TEST(DividedFaces, DifferFromSymmetricOnesInProportionToTheNoise) {
  for (int digits = 6; digits <= 10; ++digits) {
    const double noise = std::pow(10.0, -digits);
    RandomStream stream("symmetric_sites_hard", 477'012);
    const testing::SymmetricSites sites =
        testing::disturbed(testing::random_symmetric_sites(7, stream), {.noise = noise}, stream);
    SCOPED_TRACE(sites.name);
    const Diagram found = diagram(GeodesicSolver(testing::share(sites.mesh)), sites.sites);
    ASSERT_EQ(found.cells.size(), 2U);
    const double area = testing::area_of(sites.mesh);
    EXPECT_NEAR(found.cells[0].area, found.cells[1].area, 10 * noise * area);
    double length = 0;
    for (const DiagramEdge& edge : found.edges) length += edge.length;
    EXPECT_NEAR(length, 8.2068170913, 100 * noise);
  }
}

}  // namespace
}  // namespace supple::voronoi
