#include "contact_search.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

using testing::distance_to;

/// The number of visits of each image that the grid visits around `position`. Keys are (segment, shift).
std::map<std::tuple<int, int, int>, int> visits(const SegmentGrid& grid, const Eigen::Vector2d& position,
                                                double radius) {
  std::map<std::tuple<int, int, int>, int> counts;
  grid.visit(position, radius, [&](int segment, const Eigen::Vector2i& shift) {
    ++counts[{segment, shift[0], shift[1]}];
  });
  return counts;
}

TEST(SegmentGrid, VisitsOnceEveryImageInReachHoweverTheLatticeIsDeformed) {
  const tiling::PeriodicMesh mesh = testing::comb();
  const ContactOutline outline(mesh);
  RandomStream random("segment_grid", 1);
  for (int trial = 0; trial < 60; ++trial) {
    Eigen::Matrix2d f;
    f << random.uniform(0.5, 1.6), random.uniform(-2, 2), random.uniform(-0.3, 0.3), random.uniform(0.5, 1.6);
    if (trial % 3 == 0) f(0, 1) = 0;
    if (f.determinant() < 0.2) continue;
    const Eigen::Matrix2d lattice = f * outline.lattice;
    Eigen::Matrix2Xd points = f * outline.rest;
    for (Eigen::Index k = 0; k < points.size(); ++k) points(k) += 0.05 * random.normal();
    // The points may be moved by whole periods.
    if (trial % 2 == 0) points.colwise() += lattice * Eigen::Vector2d(random.below(7) - 3, random.below(7) - 3);

    const double radius = random.uniform(0.02, trial % 10 == 0 ? 3.0 : 0.4);
    SegmentGrid grid;
    grid.build(outline, lattice, points, random.uniform(0.3, 3) * radius);
    const Eigen::Vector2d position = points.col(random.below(outline.points()));
    const auto counts = visits(grid, position, radius);
    for (const auto& [key, count] : counts) EXPECT_EQ(count, 1);
    const int images = 12;
    for (int s = 0; s < static_cast<int>(outline.segments.size()); ++s)
      for (int i = -images; i <= images; ++i)
        for (int j = -images; j <= images; ++j) {
          const auto& segment = outline.segments[static_cast<std::size_t>(s)];
          const Eigen::Vector2i shift(i, j);
          const Eigen::Vector2d tail = points.col(segment.tail) + lattice * shift.cast<double>() - position;
          const Eigen::Vector2d head =
              points.col(segment.head) + lattice * (shift + segment.head_shift).cast<double>() - position;
          if (distance_to(tail, head) >= radius) continue;
          ASSERT_TRUE(counts.contains({s, i, j}))
              << "trial " << trial << ", segment " << s << ", image " << i << ' ' << j;
        }
  }
}

TEST(SegmentGrid, VisitsFewSegmentsThatAreFar) {
  const tiling::PeriodicMesh mesh = testing::wall(0.5, 200, 20);
  const ContactOutline outline(mesh);
  SegmentGrid grid;
  grid.build(outline, outline.lattice, outline.rest, 0.1);
  EXPECT_LE(visits(grid, outline.rest.col(100), 0.1).size(), 10U);
}

TEST(Outline, IsMadeOfTwoStraightSegmentsForEachSide) {
  const tiling::PeriodicMesh mesh = testing::wall(0.2, 4);
  const ContactOutline outline(mesh);
  EXPECT_EQ(mesh.outline.size(), 8U);
  EXPECT_EQ(outline.segments.size(), 16U);
  EXPECT_EQ(outline.points(), 16);
  double length = 0;
  for (const double own : outline.lengths) length += own;
  EXPECT_NEAR(length, 4, 1e-14);
}

TEST(Outline, RunsInClosedChainsThatCrossTheCellsBorder) {
  const tiling::PeriodicMesh mesh = testing::wall(0.2, 4);
  const ContactOutline outline(mesh);
  for (std::size_t s = 0; s < outline.segments.size(); ++s) {
    Eigen::Vector2i shift = Eigen::Vector2i::Zero();
    auto at = static_cast<int>(s);
    for (int k = 0; k < 8; ++k) {
      const auto& segment = outline.segments[static_cast<std::size_t>(at)];
      const Eigen::Vector2d head = outline.rest_head(segment, shift);
      shift += segment.head_shift;
      at = segment.next;
      ASSERT_GE(at, 0);
      EXPECT_EQ((outline.rest_tail(outline.segments[static_cast<std::size_t>(at)], shift) - head).norm(), 0);
    }
    EXPECT_EQ(at, static_cast<int>(s)) << "eight segments up or down the wall";
    EXPECT_EQ(std::abs(shift[1]), 1);
    EXPECT_EQ(shift[0], 0);
  }
}

TEST(Outline, LeavesOpenWhereToGoAtAPointInWhichTwoHolesMeet) {
  const ContactOutline outline(testing::draw({"#.#", ".##", "###"}, testing::equal(3, 1), testing::equal(3, 1)));
  int open = 0;
  for (const auto& segment : outline.segments) {
    if (segment.next >= 0) continue;
    ++open;
    const Eigen::Vector2d place = outline.rest_head(segment, Eigen::Vector2i::Zero());
    EXPECT_LT((place - Eigen::Vector2d(1, 2)).norm(), 1e-14);
  }
  EXPECT_EQ(open, 2);
}

TEST(Intersects, AgreesWithTestingAllSegments) {
  RandomStream random("intersects", 1);
  int crossed = 0;
  for (const tiling::PeriodicMesh& mesh :
       {testing::comb(), testing::open_ring(), testing::comb((Eigen::Matrix2d() << 1, 2, 0, 1).finished())}) {
    const ContactOutline outline(mesh);
    for (int trial = 0; trial < 12; ++trial) {
      const Eigen::VectorXd x = testing::random_motion(mesh, 0.08, 0.05, random);
      const bool expected = testing::brute_intersects(outline, x, 3);
      EXPECT_EQ(intersects(outline, x), expected);
      crossed += expected ? 1 : 0;
    }
  }
  EXPECT_GT(crossed, 4);
  EXPECT_LT(crossed, 32);
}

TEST(Intersects, SeesAPieceThatReachesIntoItsNextImage) {
  const tiling::PeriodicMesh mesh = testing::open_ring();
  const ContactOutline outline(mesh);
  const CellCoordinates coordinates{mesh.nodes.cols()};
  Eigen::VectorXd x = Eigen::VectorXd::Zero(coordinates.size());
  EXPECT_FALSE(intersects(outline, x));
  // The cell shrinks, and the ring keeps its shape. A little shear avoids sides that lie exactly on each other.
  Eigen::Matrix2d f;
  f << 0.8, 0.02, 0.03, 1;
  x.segment<4>(coordinates.strain()) << f(0, 0) - 1, f(0, 1), f(1, 0), f(1, 1) - 1;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
    x.segment<2>(2 * k) = (Eigen::Matrix2d::Identity() - f) * mesh.nodes.col(k);
  EXPECT_TRUE(intersects(outline, x));
}

TEST(Intersects, IsFalseForASolidPatch) {
  const tiling::PeriodicMesh mesh = testing::draw({"##", "##"}, testing::equal(2, 1), testing::equal(2, 1));
  EXPECT_FALSE(intersects(ContactOutline(mesh), Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4)));
}

}  // namespace
}  // namespace supple::microscale
