#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "layouts.h"
#include "supple/weave/layout_warnings.h"
#include "supple/weave/patterns.h"
#include "supple/weave/weave.h"
#include "supple/weave/weave_error.h"
#include "support/expect_error.h"

namespace supple::weave {
namespace {

/// A strand that runs to and fro `teeth` times. Two of them at right angles cross everywhere.
Strand comb(int teeth, bool upright) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>(teeth));
  for (int i = 0; i < teeth; ++i) {
    const double far = i % 2 == 0 ? 0 : teeth;
    points.emplace_back(upright ? far : i, upright ? i : far);
  }
  return {StrandCurve(points, Ends::open)};
}

std::vector<Strand> grid(int lines) {
  std::vector<Strand> strands;
  for (int i = 0; i < lines; ++i) {
    strands.push_back(line({-1.0, i}, {lines, i}));
    strands.push_back(line({i, -1.0}, {i, lines}));
  }
  return strands;
}

/// Requests a stop at the first report, and counts the reports.
class StopsAtOnce : public ProgressSink {
 public:
  void report(double /*fraction*/, std::string_view /*stage*/) override {
    ++reports;
    token.request(StopReason::cancelled);
  }
  CancellationToken token;
  int reports = 0;
};

TEST(Crossings, OfTwoCombsAreAllFound) {
  const auto crossings = find_crossings({comb(50, false), comb(50, true)});
  EXPECT_EQ(crossings.size(), 49U * 49U);
  for (std::size_t c = 1; c < crossings.size(); ++c)
    EXPECT_LT(crossings[c - 1].members[0].coordinate, crossings[c].members[0].coordinate) << c << ": one twice";
}

TEST(Crossings, OfManyStrandsThroughOnePointAreOneCrossing) {
  std::vector<Strand> strands;
  for (int i = 0; i < 150; ++i) {
    const double angle = std::numbers::pi * i / 150;
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    strands.push_back(line(-5 * d, (5 + i) * d));
  }
  const auto crossings = find_crossings(strands);
  ASSERT_EQ(crossings.size(), 1U);
  ASSERT_EQ(crossings[0].members.size(), 150U);
  for (int i = 0; i < 150; ++i) EXPECT_NEAR(crossings[0].members[static_cast<std::size_t>(i)].coordinate, 5, 1e-9);
}

TEST(Crossings, BeyondTheLimitAreRefusedByItsName) {
  const auto error =
      ::supple::testing::expect_error<WeaveError>("weave.invalid_layout", [] { find_crossings(grid(1001)); });
  EXPECT_EQ(::supple::testing::places(error), std::vector<std::string>{"strands"});
  EXPECT_NE(std::string(error.what()).find("cross at too many places: the limit is 1000000"), std::string::npos);
}

TEST(Crossings, AreNotLookedForOnceAStopIsRequested) {
  StopsAtOnce sink;
  Execution execution;
  execution.cancellation = sink.token;
  execution.progress = &sink;
  ::supple::testing::expect_cancelled(StopReason::cancelled,
                                      [&] { find_crossings(grid(20), std::nullopt, execution); });
  EXPECT_EQ(sink.reports, 1) << "it stops within the first strand";
  const Weave weave = interlacing_squares_sheet(SquareType::all_fused, 4, 4);
  ::supple::testing::expect_cancelled(StopReason::cancelled, [&] { layout_warnings(weave, execution); });
  ::supple::testing::expect_cancelled(StopReason::cancelled, [&] { validate(weave, execution); });
}

TEST(Crossings, OfCurvesWithoutEndOfTurnsAreNotReached) {
  std::vector<Eigen::Vector2d> cusps;
  for (int i = 0; i < 2000; ++i) cusps.emplace_back(i % 2, 1e-6 * i);
  const auto error = ::supple::testing::expect_error<WeaveError>("weave.invalid_strand",
                                                                 [&] { StrandCurve curve(cusps, Ends::open); });
  EXPECT_EQ(::supple::testing::places(error), std::vector<std::string>{"points"});
  Execution stopped;
  stopped.cancellation.request(StopReason::deadline);
  ::supple::testing::expect_cancelled(StopReason::deadline, [&] {
    StrandCurve curve({{0, 0}, {1, 1}, {2, 0}}, Ends::open, {0, 0}, stopped);
  });
}

}  // namespace
}  // namespace supple::weave
