// Hard because angles are pi or 2 pi but for rounding: lengths that decide what turns, and what is dropped, are equal
// in more digits than they have.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "support/cad_parts.h"
#include "support/parametric.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const TriangleMesh> turned_in_single_precision(const TriangleMesh& mesh, RandomStream& stream) {
  Eigen::Quaterniond turn(stream.normal(), stream.normal(), stream.normal(), stream.normal());
  turn.normalize();
  std::vector<Vector3d> positions = mesh.positions();
  for (Vector3d& p : positions) p = (turn * p).cast<float>().cast<double>();
  return testing::share(mesh.with_positions(std::move(positions)));
}

std::vector<std::vector<double>> all_distances(const std::shared_ptr<const TriangleMesh>& mesh) {
  const GeodesicSolver solver(mesh);
  std::vector<std::vector<double>> rows;
  for (std::int32_t v = 0; v < mesh->vertex_count(); ++v) {
    const SurfacePoint source = vertex_point(*mesh, VertexId(v));
    rows.push_back(solver.field({&source, 1}).vertex_distances());
  }
  return rows;
}

/// Symmetric and, up to the rounding of coordinates, what they are on the exact shape.
void expect_rounded(const TriangleMesh& exact_mesh, const std::vector<std::vector<double>>& exact,
                    const std::vector<std::vector<double>>& rounded) {
  // Single precision moves a vertex by 6e-8 of its coordinates, an edge by twice as much, a path at each of its bends.
  const double moved = 1e-5 * exact_mesh.diagonal();
  double asymmetry = 0;
  double change = 0;
  for (std::size_t a = 0; a < exact.size(); ++a) {
    for (std::size_t b = 0; b < exact.size(); ++b) {
      asymmetry = std::max(asymmetry, std::abs(rounded[a][b] - rounded[b][a]));
      change = std::max(change, std::abs(rounded[a][b] - exact[a][b]));
    }
  }
  EXPECT_LE(asymmetry, 1e-11 * exact_mesh.diagonal());
  EXPECT_LE(change, moved);
}

TEST(NearlyStraight, AFlatGridInSinglePrecisionTurnedInSpaceKeepsItsDistances) {
  const TriangleMesh grid = testing::flat_grid(8, 6);
  std::vector<std::vector<double>> exact(static_cast<std::size_t>(grid.vertex_count()));
  for (std::size_t a = 0; a < exact.size(); ++a)
    for (const Vector3d& p : grid.positions()) exact[a].push_back((p - grid.positions()[a]).norm());
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomStream stream("turned grids", seed);
    expect_rounded(grid, exact, all_distances(turned_in_single_precision(grid, stream)));
  }
}

TEST(NearlyStraight, AnInnerCornerOfAnLInSinglePrecisionBendsTheSamePaths) {
  const TriangleMesh shape = testing::l_shape(4);
  const auto exact = all_distances(testing::share(testing::l_shape(4)));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomStream stream("turned corners", seed);
    expect_rounded(shape, exact, all_distances(turned_in_single_precision(shape, stream)));
  }
}

TEST(NearlyStraight, FansAroundTheRimOfAHoleInSinglePrecisionKeepTheirDistances) {
  const auto ring = [] {
    return testing::parametric_grid(24, 1, testing::Wrap::u,
                                    [](int i, int j) {
                                      const double angle = 2 * std::numbers::pi * i / 24;
                                      const double radius = j == 0 ? 10 : 2;
                                      return Vector3d(radius * std::cos(angle), radius * std::sin(angle), 0);
                                    })
        .build();
  };
  const TriangleMesh plate = ring();
  const auto exact = all_distances(testing::share(ring()));
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomStream stream("turned plates", seed);
    expect_rounded(plate, exact, all_distances(turned_in_single_precision(plate, stream)));
  }
}

TEST(NearlyStraight, ConesOfNearlyTwoPiAreNearlyFlat) {
  constexpr int n = 12;
  constexpr int rings = 3;
  for (int digits = 6; digits <= 13; ++digits) {
    for (const double factor : {-5.0, -2.0, -1.0, 1.0, 2.0, 5.0}) {
      const double total = 2 * std::numbers::pi + factor * std::pow(10, -digits);
      SCOPED_TRACE("2 pi plus " + std::to_string(factor) + " times 1e-" + std::to_string(digits));
      const auto mesh = testing::share(testing::cone(n, total, rings));
      const auto found = all_distances(mesh);
      // Vertex 0 is the apex, then come rings of n vertices.
      const auto radius = [&](std::int32_t v) { return v == 0 ? 0.0 : static_cast<double>((v - 1) / n + 1) / rings; };
      for (std::int32_t a = 0; a < mesh->vertex_count(); ++a) {
        for (std::int32_t b = 0; b < mesh->vertex_count(); ++b) {
          const int steps = a == 0 || b == 0 ? 0 : std::abs((a - 1) % n - (b - 1) % n);
          const double angle = std::min(std::min(steps, n - steps) * total / n, std::numbers::pi);
          const double exact =
              std::sqrt(radius(a) * radius(a) + radius(b) * radius(b) - 2 * radius(a) * radius(b) * std::cos(angle));
          EXPECT_NEAR(found[a][b], exact, 1e-12) << a << " to " << b;
        }
      }
    }
  }
}

TEST(NearlyStraight, ABoundaryThatWavesByRoundingIsAsLongAsTheStraightOne) {
  // A strip whose long sides wave by 1e-6 to 1e-13: paths along it pass hundreds of places at which they may turn.
  constexpr int n = 60;
  for (int digits = 6; digits <= 13; ++digits) {
    SCOPED_TRACE("waves of 1e-" + std::to_string(digits));
    RandomStream stream("waving strips", static_cast<std::uint64_t>(digits));
    const double wave = std::pow(10, -digits);
    testing::Soup soup = testing::parametric_grid(n, 2, testing::Wrap::none, [&](int i, int j) {
      return Vector3d(i, j + (i > 0 && i < n ? wave * stream.normal() : 0), wave * stream.normal());
    });
    const auto mesh = testing::share(std::move(soup).build());
    const GeodesicSolver solver(mesh);
    for (const auto& [a, b] : {std::pair(0, n), std::pair(n + 1, 2 * n + 1), std::pair(2 * n + 2, 3 * n + 2)}) {
      const SurfacePoint from = vertex_point(*mesh, VertexId(a));
      const SurfacePoint to = vertex_point(*mesh, VertexId(b));
      const double there = solver.field({&from, 1}).vertex_distances()[static_cast<std::size_t>(b)];
      const double back = solver.field({&to, 1}).vertex_distances()[static_cast<std::size_t>(a)];
      EXPECT_NEAR(there, back, 1e-11);
      EXPECT_NEAR(solver.distance(from, to), there, 1e-11);
      EXPECT_GE(there, (mesh->positions()[a] - mesh->positions()[b]).norm() - 1e-12);
      EXPECT_LE(there, n + 20 * n * wave * wave + 1e-12);
    }
  }
}

TEST(NearlyStraight, PairsBetweenAnyPointsOfPartsAreSymmetricAndFollowTheirPaths) {
  int pairs = 0;
  int differently_unique = 0;
  for (std::uint64_t seed = 0; seed < 25; ++seed) {
    RandomStream stream("points of cad parts", seed);
    testing::CadPart part = testing::cad_part(stream);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + part.description);
    const auto mesh = testing::share(std::move(part.mesh));
    const GeodesicSolver solver(mesh);
    const testing::SurfaceSampler sampler(*mesh);
    const double tolerance = 1e-9 * mesh->diagonal();
    const auto draw = [&](int kind) {
      return kind == 0   ? sampler.point(stream)
             : kind == 1 ? testing::random_edge_point(*mesh, stream)
                         : testing::random_vertex_point(*mesh, stream);
    };
    for (int i = 0; i < 60; ++i) {
      const SurfacePoint a = draw(i % 3);
      const SurfacePoint b = draw(i / 3 % 3);
      const Geodesic there = solver.geodesic(a, b, {.path = true});
      const Geodesic back = solver.geodesic(b, a);
      EXPECT_NEAR(there.distance, back.distance, tolerance) << "pair " << i;
      ++pairs;
      differently_unique += there.unique != back.unique;
      double along_path = 0;
      for (std::size_t k = 1; k < there.path.size(); ++k)
        along_path += (there.path[k].position - there.path[k - 1].position).norm();
      EXPECT_NEAR(along_path, there.distance, tolerance) << "pair " << i;
    }
  }
  // A path that hugs a vertex may have a competitor next to it as seen from one end alone. A bend at a vertex that
  // holds the path is no competitor: where it counted as one, 8 % of the pairs were unique from one end only.
  EXPECT_LE(differently_unique, pairs / 100);
}

}  // namespace
}  // namespace supple::surface
