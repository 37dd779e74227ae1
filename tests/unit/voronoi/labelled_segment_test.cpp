#include "labelled_segment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "supple/base/random.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

FaceDistances of(std::vector<surface::FaceArrival> arrivals) {
  static const CancellationToken never;
  FaceDistances distances(never);
  distances.arrivals() = std::move(arrivals);
  return distances;
}

LabelledSegment label(const FaceDistances& distances, const Vector2d& from, const Vector2d& to) {
  Active active;
  distances.all(active);
  return label_segment(distances, active, from, to, distances.nearest(active, from).site,
                       distances.nearest(active, to).site);
}

TEST(LabelledSegment, IsCutHalfwayBetweenTwoSites) {
  const auto result =
      label(of({{.image = Vector2d(0.25, 1), .source = 4}, {.image = Vector2d(0.75, 1), .source = 7}}), {0, 0}, {1, 0});
  EXPECT_EQ(result.sites, (std::vector<std::int32_t>{4, 7}));
  ASSERT_EQ(result.cuts.size(), 1U);
  EXPECT_NEAR(result.cuts[0], 0.5, 1e-15);
  EXPECT_NEAR(result.distances[0], std::hypot(0.25, 1), 1e-15);
}

TEST(LabelledSegment, IsCutTwiceWhereASiteOfLargerOffsetIsNearInTheMiddleOnly) {
  // The sites A = 0 and B = 1 are equally near where |x - A| = 0.7 + |x - B|, on both sides of the middle.
  const auto result =
      label(of({{.image = Vector2d(0.5, 1), .source = 0}, {.image = Vector2d(0.5, 0.1), .sigma = 0.7, .source = 1}}),
            {0, 0}, {1, 0});
  EXPECT_EQ(result.sites, (std::vector<std::int32_t>{0, 1, 0}));
  ASSERT_EQ(result.cuts.size(), 2U);
  for (const double cut : result.cuts) EXPECT_NEAR(std::hypot(cut - 0.5, 1), 0.7 + std::hypot(cut - 0.5, 0.1), 1e-14);
}

TEST(LabelledSegment, KeepsTheSiteBeforeAlongATie) {
  const auto result =
      label(of({{.image = Vector2d(0.3, 1), .source = 0}, {.image = Vector2d(0.3, -1), .source = 1}}), {0, 0}, {1, 0});
  EXPECT_EQ(result.sites.size(), 1U);
}

TEST(LabelledSegment, ReachesTheSitesThatItsEndsAreGiven) {
  const FaceDistances distances =
      of({{.image = Vector2d(0.3, 1), .source = 0}, {.image = Vector2d(0.3, -1), .source = 1}});
  Active active;
  distances.all(active);
  const auto result = label_segment(distances, active, {0, 0}, {1, 0}, 0, 1);
  EXPECT_EQ(result.sites.front(), 0);
  EXPECT_EQ(result.sites.back(), 1);
}

TEST(LabelledSegment, FindsEveryPartThatSamplingFinds) {
  RandomStream random("voronoi", 11);
  int parts = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<surface::FaceArrival> arrivals;
    const int count = 2 + static_cast<int>(8 * random.uniform());
    for (int i = 0; i < count; ++i) {
      const double begin = random.uniform();
      arrivals.push_back({.image = Vector2d(3 * random.uniform() - 1, -1.5 * random.uniform()),
                          .begin = Vector2d(begin, 0),
                          .end = Vector2d(begin + (1 - begin) * random.uniform(), 0),
                          .sigma = 0.3 * random.uniform(),
                          .source = i % 5,
                          .everywhere = random.uniform() < 0.5});
    }
    const FaceDistances distances = of(std::move(arrivals));
    const Vector2d from(random.uniform(), 0.5 * random.uniform());
    const Vector2d to(random.uniform(), 0.5 * random.uniform());
    const auto result = label(distances, from, to);
    parts += static_cast<int>(result.sites.size());
    Active active;
    distances.all(active);
    for (int k = 0; k <= 500; ++k) {
      const double share = k / 500.0;
      const auto part = static_cast<std::size_t>(std::upper_bound(result.cuts.begin(), result.cuts.end(), share) -
                                                 result.cuts.begin());
      const Vector2d point = from + share * (to - from);
      EXPECT_LE(distances.from_site(active, result.sites[part], point).distance,
                distances.nearest(active, point).distance + 1e-11)
          << round << " at " << share;
    }
  }
  EXPECT_GT(parts, 350);
}

}  // namespace
}  // namespace supple::voronoi
