#include "supple/lab/load_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/sobol.h"

namespace supple::lab {
namespace {

using dataset::LoadKind;

double distance_from_rest(const PlannedPath& path, const std::array<double, 2>& stretch) {
  const double lateral = path.path.kind == LoadKind::biaxial ? std::abs(stretch[1] - 1) : 0;
  return std::max(std::abs(stretch[0] - 1), lateral);
}

std::vector<PlannedPath> plan_of_design(const LoadPlanOptions& options, std::uint32_t index) {
  const auto point = SobolSequence("load_plan_test", 1).point(index);
  return plan_loads(options, {point[4], point[5], point[6], point[7]}, index);
}

TEST(LoadPlan, HasThePathsAndStatesAskedFor) {
  LoadPlanOptions options;
  options.tension_paths = 1;
  options.compression_paths = 0;
  options.biaxial_paths = 2;
  options.tension_states = 7;
  options.biaxial_states = 1;
  const auto plan = plan_of_design(options, 3);
  ASSERT_EQ(plan.size(), 3U);
  EXPECT_EQ(plan[0].stretches.size(), 7U);
  EXPECT_EQ(plan[0].path.planned, 7);
  EXPECT_EQ(plan[1].path.kind, LoadKind::biaxial);
  EXPECT_EQ(plan[2].stretches.size(), 1U);
}

TEST(LoadPlan, LeadsEveryPathAwayFromRestToTheLimitOfItsRange) {
  const LoadPlanOptions options;
  for (std::uint32_t design = 0; design < 200; ++design) {
    for (const PlannedPath& path : plan_of_design(options, design)) {
      double before = 0;
      for (const auto& stretch : path.stretches) {
        const double now = distance_from_rest(path, stretch);
        EXPECT_GT(now, before);
        EXPECT_GE(now, options.first_strain * (1 - 1e-9));
        before = now;
      }
      const auto& end = path.stretches.back();
      if (path.path.kind == LoadKind::uniaxial) {
        EXPECT_TRUE(end[0] == 1.5 || end[0] == 0.7) << end[0];
        EXPECT_EQ(end[1], 0);
      } else {
        for (const double s : end) {
          EXPECT_GE(s, 0.9 - 1e-12);
          EXPECT_LE(s, 1.2 + 1e-12);
        }
        const double to_border = std::min(std::min(end[0] - 0.9, 1.2 - end[0]), std::min(end[1] - 0.9, 1.2 - end[1]));
        EXPECT_NEAR(to_border, 0, 1e-12);
      }
    }
  }
}

TEST(LoadPlan, KeepsBiaxialStatesOnTheRayFromRest) {
  for (const PlannedPath& path : plan_of_design({}, 11)) {
    if (path.path.kind != LoadKind::biaxial) continue;
    const auto& end = path.stretches.back();
    for (const auto& s : path.stretches) EXPECT_NEAR((s[0] - 1) * (end[1] - 1), (s[1] - 1) * (end[0] - 1), 1e-15);
  }
}

TEST(LoadPlan, HasAsManyStatesInTheSmallestStrainsAsFarOut) {
  int near = 0;
  int far = 0;
  for (std::uint32_t design = 0; design < 500; ++design) {
    for (const PlannedPath& path : plan_of_design({}, design)) {
      if (path.path.end_stretch != 1.5) continue;
      for (const auto& s : path.stretches) {
        if (s[0] < 1.05) ++near;
        if (s[0] > 1.2) ++far;
      }
    }
  }
  EXPECT_GT(near, 1500);
  EXPECT_GT(far, 1500);
}

TEST(LoadPlan, SpreadsDirectionsAndBiaxialEndsEvenlyOverTheDesigns) {
  constexpr int bins = 16;
  std::vector<int> tension(bins);
  std::vector<int> biaxial(bins);
  std::vector<int> upper_sides(2);
  constexpr std::uint32_t designs = 1024;
  for (std::uint32_t design = 0; design < designs; ++design) {
    for (const PlannedPath& path : plan_of_design({}, design)) {
      ASSERT_GE(path.path.direction, 0);
      ASSERT_LT(path.path.direction, std::numbers::pi);
      const auto bin = static_cast<std::size_t>(path.path.direction / std::numbers::pi * bins);
      if (path.path.end_stretch == 1.5) ++tension[bin];
      if (path.path.kind == LoadKind::biaxial) {
        ++biaxial[bin];
        const bool upper = path.path.end_stretch > 1.2 - 1e-12 || path.path.end_lateral_stretch > 1.2 - 1e-12;
        ++upper_sides[upper ? 1 : 0];
      }
    }
  }
  for (const int count : tension) EXPECT_EQ(count, 2 * designs / bins);
  for (const int count : biaxial) EXPECT_NEAR(count, 3.0 * designs / bins, 4);
  EXPECT_NEAR(upper_sides[0], upper_sides[1], 20);
}

TEST(LoadPlan, IsTheSameForTheSameDesignOnly) {
  const auto a = plan_of_design({}, 5);
  const auto again = plan_of_design({}, 5);
  const auto other = plan_of_design({}, 6);
  for (std::size_t p = 0; p < a.size(); ++p) {
    EXPECT_EQ(a[p].stretches, again[p].stretches);
    EXPECT_EQ(a[p].path.direction, again[p].path.direction);
    EXPECT_NE(a[p].stretches, other[p].stretches);
    EXPECT_NE(a[p].path.direction, other[p].path.direction);
  }
}

TEST(LoadPlan, CanBeTheGridOfPublishedData) {
  LoadPlanOptions options;
  options.kind = PlanKind::grid;
  const auto plan = plan_of_design(options, 0);
  std::size_t uniaxial = 0;
  std::size_t biaxial = 0;
  for (const PlannedPath& path : plan)
    (path.path.kind == LoadKind::uniaxial ? uniaxial : biaxial) += path.stretches.size();
  EXPECT_EQ(uniaxial, 15U * (32 + 19));
  EXPECT_EQ(biaxial, 15U * 100);
  EXPECT_NEAR(plan.back().path.direction, 14 * std::numbers::pi / 15, 1e-15);
}

TEST(LoadPlan, GivesTheEngineTheSameStretches) {
  for (const PlannedPath& path : plan_of_design({}, 2)) {
    const microscale::Load load = path.load();
    ASSERT_EQ(microscale::size(load), path.path.planned);
    if (const auto* uniaxial = std::get_if<microscale::UniaxialLoad>(&load)) {
      EXPECT_EQ(uniaxial->stretches.back(), path.path.end_stretch);
      EXPECT_EQ(uniaxial->direction, path.path.direction);
    } else {
      const auto& end = std::get<microscale::BiaxialLoad>(load).stretches.back();
      EXPECT_EQ(end[0], path.path.end_stretch);
      EXPECT_EQ(end[1], path.path.end_lateral_stretch);
    }
  }
}

TEST(LoadPlan, RefusesOptionsOutOfRangeAndNamesEach) {
  LoadPlanOptions options;
  options.tension_states = 0;
  options.min_stretch = 1.1;
  try {
    check(options);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "dataset.invalid_option");
    ASSERT_EQ(error.details().size(), 2U);
    EXPECT_EQ(error.details()[0].where, "tension_states");
    EXPECT_EQ(error.details()[1].where, "smallest_stretch");
  }
  LoadPlanOptions none;
  none.tension_paths = none.compression_paths = none.biaxial_paths = 0;
  EXPECT_THROW(check(none), Error);
}

}  // namespace
}  // namespace supple::lab
