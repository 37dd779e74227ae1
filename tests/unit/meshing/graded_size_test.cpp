#include "graded_size.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "supple/base/random.h"

namespace supple::meshing {
namespace {

TEST(GradedSize, IsTheLeastOverAllSources) {
  RandomStream random("graded_size", 1);
  const auto somewhere = [&] {
    return Eigen::Vector3d(Eigen::Vector3d::NullaryExpr([&] { return random.uniform(-1, 1); }));
  };
  std::vector<GradedSize::Source> sources;
  for (int i = 0; i < 300; ++i) sources.push_back({somewhere(), random.uniform(0.01, 0.6)});
  const double largest = 0.5;
  const double grading = 0.3;
  const GradedSize size(sources, largest, grading);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d point = 2 * somewhere();
    double least = largest;
    for (const auto& source : sources)
      least = std::min(least, source.length + grading * (source.position - point).norm());
    EXPECT_DOUBLE_EQ(size(point), least);
  }
}

TEST(GradedSize, IsTheLargestWhereNoSourceIsFiner) {
  EXPECT_EQ(GradedSize({}, 2, 1)(Eigen::Vector3d::Zero()), 2);
  EXPECT_EQ(GradedSize({{Eigen::Vector3d::Zero(), 3}}, 2, 1)(Eigen::Vector3d::Zero()), 2);
}

}  // namespace
}  // namespace supple::meshing
