// Edges that are straight only up to the digits of a file: what makes meshes of machined parts hard.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "support/cad_parts.h"
#include "support/cgal_geodesics.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::CgalGeodesics;

/// Difference of the distances in both directions, over the diagonal of the part.
constexpr double symmetry_tolerance = 1e-9;

std::vector<double> distances_from(const GeodesicSolver& solver, std::int32_t v) {
  const SurfacePoint source = vertex_point(solver.mesh(), VertexId(v));
  return solver.field({&source, 1}).vertex_distances();
}

/// Every pair of vertices, by fields and by searches for pairs, in both directions and against CGAL.
void expect_all_pairs_right(const std::shared_ptr<const TriangleMesh>& mesh) {
  const GeodesicSolver solver(mesh);
  CgalGeodesics cgal(*mesh);
  const double tolerance = symmetry_tolerance * mesh->diagonal();
  for (std::int32_t a = 0; a < mesh->vertex_count(); ++a) {
    const SurfacePoint from = vertex_point(*mesh, VertexId(a));
    cgal.set_source(from);
    cgal.search();
    const std::vector<double> exact = cgal.vertex_distances();
    const std::vector<double> field = distances_from(solver, a);
    for (std::int32_t b = 0; b < mesh->vertex_count(); ++b) {
      EXPECT_NEAR(field[b], exact[b], tolerance) << "field from " << a << " to " << b;
      const Geodesic pair = solver.geodesic(from, vertex_point(*mesh, VertexId(b)), {.path = true});
      EXPECT_NEAR(pair.distance, exact[b], tolerance) << "pair from " << a << " to " << b;
      double along_path = 0;
      for (std::size_t i = 1; i < pair.path.size(); ++i)
        along_path += (pair.path[i].position - pair.path[i - 1].position).norm();
      EXPECT_NEAR(along_path, exact[b], tolerance) << "path from " << a << " to " << b;
    }
  }
}

TEST(CadParts, APathAlongAnEdgeThatIsStraightToAMillionthReachesItsEnd) {
  // A wall, whose upper edge runs along x, and a flap in its plane z = 0. Two vertices of the edge are off by 1e-6 and
  // 1e-8, so that the way on the flap and the way on the wall differ by less than one part in 10^12.
  const auto mesh = testing::share(TriangleMesh::build(
      {{0, 0, 0}, {1, -1e-6, 0}, {2, -1e-8, 0}, {2.5, 0, 0}, {3.5, 0, 0}, {0, 0, -1}, {2.5, 0, -1}, {1, -1, 0}},
      {{5, 1, 0}, {5, 6, 1}, {6, 2, 1}, {6, 3, 2}, {6, 4, 3}, {7, 1, 2}, {7, 2, 3}}));
  const GeodesicSolver solver(mesh);
  EXPECT_NEAR(distances_from(solver, 0)[4], 3.5, 1e-11);
  EXPECT_NEAR(distances_from(solver, 4)[0], 3.5, 1e-11);
  expect_all_pairs_right(mesh);
}

TEST(CadParts, APairAcrossACornerOfSixDigitsIsAsLongAsItsReverse) {
  // A rib beside a countersink, as a file with six digits has it: the rim of the rib has vertices that lie on its
  // straight edge up to 1e-6.
  const auto mesh = testing::share(TriangleMesh::build({{0.54205, -2.06375, 0},
                                                        {0.458271, -0.79375, 0},
                                                        {1.08291, -1.7271, 0},
                                                        {0.9165429, -1.5875, 0},
                                                        {0.9874, -1.672, 0},
                                                        {0.4583, -2.0637, 0},
                                                        {0, 0, 0},
                                                        {0.916543, -1.5875, -0.9525},
                                                        {0.542054, -0.938866, 0},
                                                        {0.94829, -1.632835, -0.9525},
                                                        {0, 0, -0.9525},
                                                        {1.1364, -1.7414, 0},
                                                        {1.0328, -1.7037, 0},
                                                        {0.94829, -1.63283, 0}},
                                                       {{0, 11, 2},
                                                        {0, 13, 3},
                                                        {2, 12, 0},
                                                        {0, 12, 4},
                                                        {0, 4, 13},
                                                        {3, 8, 0},
                                                        {0, 8, 1},
                                                        {0, 1, 5},
                                                        {10, 6, 1},
                                                        {10, 1, 7},
                                                        {7, 1, 8},
                                                        {7, 8, 3},
                                                        {4, 9, 13},
                                                        {13, 9, 7},
                                                        {13, 7, 3}}));
  const GeodesicSolver solver(mesh);
  const SurfacePoint a = vertex_point(*mesh, VertexId(6));
  const SurfacePoint b = vertex_point(*mesh, VertexId(11));
  EXPECT_NEAR(solver.distance(a, b), 2.10982544134, 1e-10);
  EXPECT_NEAR(solver.distance(b, a), 2.10982544134, 1e-10);
  expect_all_pairs_right(mesh);
}

TEST(CadParts, FieldsOfGeneratedPartsAreSymmetricReachEveryVertexAndAgreeWithCgal) {
  // Fields of the first parts miss vertices, or are too long, if a vertex sends windows behind one of its paths only.
  std::vector<std::uint64_t> seeds{126, 555, 578, 846, 1633, 1733, 1841, 1940, 2571, 2817, 2998};
  for (std::uint64_t seed = 0; seed < 40; ++seed) seeds.push_back(seed);
  for (const std::uint64_t seed : seeds) {
    RandomStream stream("cad parts", seed);
    testing::CadPart part = testing::cad_part(stream);
    SCOPED_TRACE("part " + std::to_string(seed) + ": " + part.description);
    const auto mesh = testing::share(std::move(part.mesh));
    const GeodesicSolver solver(mesh);
    CgalGeodesics cgal(*mesh);
    const double tolerance = symmetry_tolerance * mesh->diagonal();
    std::vector<std::vector<double>> ours;
    std::vector<std::vector<double>> theirs;
    const std::int32_t n = std::min(mesh->vertex_count(), 25);
    for (std::int32_t k = 0; k < n; ++k) {
      const std::int32_t v = k * mesh->vertex_count() / n;
      ours.push_back(distances_from(solver, v));
      cgal.set_source(vertex_point(*mesh, VertexId(v)));
      cgal.search();
      theirs.push_back(cgal.vertex_distances());
    }
    for (std::int32_t i = 0; i < n; ++i) {
      const auto row = static_cast<std::size_t>(i);
      double most = -1;
      for (std::int32_t h = 0; h < mesh->halfedge_count(); ++h) {
        most = std::max(most, ours[row][mesh->head(h)] - ours[row][mesh->tail(h)] - mesh->edge_length(h));
      }
      EXPECT_LE(most, tolerance) << "from " << i * mesh->vertex_count() / n;
      for (std::int32_t k = 0; k < n; ++k) {
        const auto other = static_cast<std::size_t>(k);
        const auto from = static_cast<std::size_t>(i * mesh->vertex_count() / n);
        const auto to = static_cast<std::size_t>(k * mesh->vertex_count() / n);
        const double there = ours[row][to];
        EXPECT_NEAR(there, ours[other][from], tolerance) << from << " to " << to;
        // CGAL 5.5 itself misses ways on such parts; then its answers in both directions differ.
        if (std::abs(theirs[row][to] - theirs[other][from]) > tolerance) continue;
        EXPECT_NEAR(there, theirs[row][to], tolerance) << from << " to " << to;
      }
    }
  }
}

}  // namespace
}  // namespace supple::surface
