#include "window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "supple/base/random.h"

namespace supple::surface {
namespace {

constexpr int samples = 400;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A window on an edge of length 1. Sigmas and depths are often equal, as those of windows from one vertex are.
Window random_window(RandomStream& random) {
  Window window{};
  const bool wide = random.below(3) == 0;
  window.b0 = wide ? 0 : random.uniform(0, 0.8);
  window.b1 = wide ? 1 : random.uniform(window.b0 + 0.05, 1);
  // Of two sources one before the other, the nearer may win in the middle only.
  window.source_x = random.below(3) == 0 ? random.uniform(0.4, 0.6) : random.uniform(-1.5, 2.5);
  window.depth = random.below(3) == 0 ? 0.5 : random.uniform(0.01, 1.5);
  window.sigma = random.below(3) == 0 ? 0.25 : random.uniform(0, 1);
  return window;
}

double length_within(const Window& window, double x) {
  return x >= window.b0 && x <= window.b1 ? length_at(window, x) : infinity;
}

double sample(double low, double high, int i) { return low + (high - low) * (i + 0.5) / samples; }

TEST(Window, PairsKeepTheirLowerEnvelope) {
  RandomStream random("window", 1);
  for (int trial = 0; trial < 20'000; ++trial) {
    const Window p = random_window(random);
    const Window w = random_window(random);
    Window left = p;
    Window right = w;
    trim_to_envelope(left, right);
    for (int i = 0; i < samples; i += 7) {
      const double x = sample(0, 1, i);
      const double before = std::min(length_within(p, x), length_within(w, x));
      const double after = std::min(length_within(left, x), length_within(right, x));
      if (before == infinity) continue;
      ASSERT_LE(after, before * (1 + 2 * drop_tolerance)) << "trial " << trial << ", x " << x;
    }
  }
}

TEST(Window, PairsOverlapNoMoreUnlessOneOfThemWouldBeCutInTwo) {
  RandomStream random("window", 2);
  int apart = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const Window p = random_window(random);
    const Window w = random_window(random);
    const double a = std::max(p.b0, w.b0);
    const double b = std::min(p.b1, w.b1);
    if (b - a < 0.01) continue;
    Window left = p;
    Window right = w;
    trim_to_envelope(left, right);
    const double overlap = std::min(left.b1, right.b1) - std::max(left.b0, right.b0);
    // Less falls between the samples below.
    if (overlap < 0.01) {
      ++apart;
      continue;
    }
    // The shorter one along the overlap, with one entry for each change.
    std::vector<bool> shorter;
    for (int i = 0; i < samples; ++i) {
      const double x = sample(a, b, i);
      const bool first = length_at(p, x) < length_at(w, x);
      if (shorter.empty() || shorter.back() != first) shorter.push_back(first);
    }
    const bool twice = shorter.size() > 2;
    const Window& loser = shorter[0] ? w : p;
    const bool split = shorter.size() == 1 && loser.b0 < a && loser.b1 > b;
    // The sides of one crossing are given away one by one: a window that goes on beyond both ends keeps its middle.
    const Window& before = shorter[0] ? p : w;
    const bool beyond = shorter.size() == 2 && (before.b1 > b || loser.b0 < a);
    ASSERT_TRUE(twice || split || beyond) << "trial " << trial << ": overlap of " << overlap;
  }
  EXPECT_GT(apart, 5'000);
}

TEST(Window, IsCutToWhereItBeatsBothVertices) {
  RandomStream random("window", 3);
  int dead = 0;
  int whole = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    const Window before = random_window(random);
    const VertexBounds bounds{random.uniform(0, 2), random.uniform(0, 2)};
    Window after = before;
    const Cut cut_off = cut(after, bounds, 1);
    const auto excess = [&](double x) {
      return length_at(before, x) - before.sigma - std::min(bounds.tail + x, bounds.head + 1 - x);
    };
    ASSERT_TRUE(after.b0 >= before.b0 && after.b1 <= before.b1) << trial;
    for (int i = 0; i < samples; i += 7) {
      const double x = sample(before.b0, before.b1, i);
      const bool kept = !cut_off.empty && x >= after.b0 && x <= after.b1;
      if (std::abs(excess(x)) < 1e-9) continue;
      ASSERT_EQ(kept, excess(x) < 0) << "trial " << trial << ", x " << x;
    }
    dead += cut_off.empty ? 1 : 0;
    whole += !cut_off.by_tail && !cut_off.by_head ? 1 : 0;
  }
  EXPECT_GT(dead, 1'000);
  EXPECT_GT(whole, 1'000);
}

TEST(Window, KnowsItsShortestWayToAPoint) {
  RandomStream random("window", 4);
  for (int trial = 0; trial < 2'000; ++trial) {
    const Window window = random_window(random);
    const double x = random.uniform(-1, 2);
    const double y = trial % 10 == 0 ? 0 : random.uniform(0, 2);
    double crossing = 0;
    const double length = length_to(window, x, y, crossing);
    ASSERT_TRUE(crossing >= window.b0 && crossing <= window.b1);
    EXPECT_NEAR(length_at(window, crossing) + hypotenuse(x - crossing, y), length, 1e-12);
    for (int i = 0; i < samples; ++i) {
      const double by = sample(window.b0, window.b1, i);
      ASSERT_LE(length, length_at(window, by) + hypotenuse(x - by, y) + 1e-12) << "trial " << trial;
    }
  }
}

}  // namespace
}  // namespace supple::surface
