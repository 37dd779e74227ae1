// Hard cases of diagrams on symmetric shapes: borders coincide with edges, vertices, diagonals and cut loci, exactly or
// up to rounding. Each shape is drawn with its sites, and then rotated, rounded to single precision or disturbed.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/voronoi/diagram.h"
#include "support/shapes.h"
#include "support/symmetric_shapes.h"
#include "support/valid_diagram.h"

namespace supple::voronoi {
namespace {

/// Checks `draws` disturbed shapes of each family. Areas of equal sites are compared only if `symmetric`. Otherwise
/// they may differ much, because a region behind a saddle vertex on a border goes to one site or the other.
void expect_valid(const testing::Disturbance& disturbance, int draws, bool symmetric, std::uint64_t first_seed) {
  for (int family = 0; family < testing::symmetric_families; ++family) {
    for (int draw = 0; draw < draws; ++draw) {
      const std::uint64_t seed =
          first_seed + 1000 * static_cast<std::uint64_t>(family) + static_cast<std::uint64_t>(draw);
      RandomStream stream("symmetric_sites_hard", seed);
      const testing::SymmetricSites drawn =
          testing::disturbed(testing::random_symmetric_sites(family, stream), disturbance, stream);
      SCOPED_TRACE("family " + std::to_string(family) + ", seed " + std::to_string(seed) + ", " + drawn.name);
      const Diagram found = diagram(surface::GeodesicSolver(testing::share(drawn.mesh)), drawn.sites);
      // Next to a tip, a disturbance turns one border into many, some of which are as short as the disturbance.
      testing::DiagramTolerance tolerance;
      tolerance.distance += disturbance.noise;
      if (!symmetric) tolerance.area = 1e-11;
      testing::expect_valid_diagram(drawn.mesh, found, tolerance);
      EXPECT_TRUE(found.warnings.empty());
      const double areas = 1e-9 * testing::area_of(drawn.mesh);
      for (std::size_t i = 0; i < found.cells.size() && symmetric; ++i)
        for (std::size_t j = 0; j < i; ++j) {
          if (drawn.orbits[i] != drawn.orbits[j]) continue;
          EXPECT_NEAR(found.cells[i].area, found.cells[j].area, areas) << "sites " << i << " and " << j;
        }
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(SymmetricSites, AreToldApartAlongEdgesAndDiagonals) { expect_valid({}, 100, true, 0); }

TEST(SymmetricSites, AreToldApartOnceTheShapeIsTurned) { expect_valid({.turned = true}, 100, true, 100'000); }

TEST(SymmetricSites, AreToldApartInSinglePrecision) {
  expect_valid({.float32 = true}, 50, false, 200'000);
  expect_valid({.turned = true, .float32 = true}, 50, false, 300'000);
}

TEST(SymmetricSites, AreToldApartNextToTheSymmetry) {
  for (int digits = 6; digits <= 15; ++digits) {
    const double noise = std::pow(10.0, -digits);
    expect_valid({.noise = noise}, 20, false, 400'000 + 10'000 * static_cast<std::uint64_t>(digits));
  }
}

}  // namespace
}  // namespace supple::voronoi
