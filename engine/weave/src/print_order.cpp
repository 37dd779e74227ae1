#include "print_order.h"
#include "supple/weave/weave_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <queue>
#include <utility>

namespace supple::weave {
namespace {

/// Minimum sine of a crossing angle: 10 degrees. At a smaller angle the strands overlap over a length that is too long
/// for a lift.
const double min_sine = std::sin(10 * std::numbers::pi / 180);

Eigen::Vector2d tangent(const Weave& weave, const CrossingMember& member) {
  return weave.strands[static_cast<std::size_t>(member.strand)].curve.at(member.coordinate).first.normalized();
}

/// Reports a cycle of strands each of which would have to be below the next one. It goes from each strand to one that
/// must be printed before it, until a strand repeats.
[[noreturn]] void refuse_cycle(const std::vector<SlidingCrossing>& crossings, const std::vector<char>& printed) {
  const auto blocking_crossing = [&](int strand) -> const SlidingCrossing& {
    return *std::find_if(crossings.begin(), crossings.end(), [&](const SlidingCrossing& c) {
      return c.upper == strand && std::any_of(c.below.begin(), c.below.end(),
                                              [&](int b) { return printed[static_cast<std::size_t>(b)] == 0; });
    });
  };
  const auto blocking_strand = [&](const SlidingCrossing& c) {
    return *std::find_if(c.below.begin(), c.below.end(),
                         [&](int b) { return printed[static_cast<std::size_t>(b)] == 0; });
  };
  int strand = 0;
  while (printed[static_cast<std::size_t>(strand)] != 0) ++strand;
  // Each remaining strand has one that must be printed before it: after as many steps as there are strands, the current
  // one is on a cycle.
  for (std::size_t i = 0; i < printed.size(); ++i) strand = blocking_strand(blocking_crossing(strand));
  const int start = strand;
  PrintFaults faults;
  do {
    const SlidingCrossing& c = blocking_crossing(strand);
    strand = blocking_strand(c);
    faults.add(crossing_name(c.crossing), strand_name(c.upper) + " slides across " + strand_name(strand) +
                                              " and would have to be printed after it, which elsewhere must come " +
                                              "first: strands in a ring lie below each other");
  } while (strand != start);
  faults.throw_if_any();
  std::abort();  // not reached: a cycle has at least one crossing
}

}  // namespace

void PrintFaults::throw_if_any() const {
  if (!details_.empty())
    throw NotPrintable("weave.not_printable", details_.front().where + " " + details_.front().message, details_);
}

std::string crossing_name(int crossing) { return "crossings/" + std::to_string(crossing); }
std::string strand_name(int strand) { return "strands/" + std::to_string(strand); }

std::string mm(double length) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.4f mm", length);
  return text.data();
}

std::vector<SlidingCrossing> sliding_crossings(const Weave& weave, PrintFaults& faults) {
  std::vector<SlidingCrossing> result;
  for (std::size_t c = 0; c < weave.crossings.size(); ++c) {
    const auto& members = weave.crossings[c].members;
    const auto sliding = std::count_if(members.begin(), members.end(), [](const auto& m) { return m.slides; });
    if (sliding == 0) continue;
    const auto number = static_cast<int>(c);
    if (sliding > 1) {
      faults.add(crossing_name(number), "has " + std::to_string(sliding) + " strands that slide; one can be printed");
      continue;
    }
    const CrossingMember& upper = *std::find_if(members.begin(), members.end(), [](const auto& m) { return m.slides; });
    SlidingCrossing found{number, upper.strand, upper.coordinate, -1, 0, -1, 1, {}};
    const Eigen::Vector2d along = tangent(weave, upper);
    for (const CrossingMember& member : members) {
      if (member.slides) continue;
      const Eigen::Vector2d across = tangent(weave, member);
      const double sine = std::abs(along[0] * across[1] - along[1] * across[0]);
      found.below.push_back(member.strand);
      found.min_sine = std::min(found.min_sine, sine);
      if (sine > found.sine) {
        found.sine = sine;
        found.bottom = member.strand;
        found.bottom_coordinate = member.coordinate;
      }
    }
    if (found.min_sine < min_sine) {
      faults.add(crossing_name(number), "its strands meet at less than 10 degrees: too nearly parallel for a lift");
      continue;
    }
    result.push_back(std::move(found));
  }
  return result;
}

std::vector<int> print_order(int strands, const std::vector<SlidingCrossing>& crossings,
                             const std::vector<int>& requested) {
  const auto count = static_cast<std::size_t>(strands);
  std::vector<int> rank(count, -1);
  if (!requested.empty()) {
    bool good = requested.size() == count;
    for (std::size_t i = 0; good && i < count; ++i) {
      const int s = requested[i];
      good = s >= 0 && s < strands && rank[static_cast<std::size_t>(s)] < 0;
      if (good) rank[static_cast<std::size_t>(s)] = static_cast<int>(i);
    }
    const std::string message = "must name each of the " + std::to_string(strands) + " strands once";
    if (!good) throw InvalidOption("weave.invalid_option", "order " + message, {{"order", message}});
    PrintFaults faults;
    for (const SlidingCrossing& c : crossings)
      for (const int b : c.below)
        if (rank[static_cast<std::size_t>(b)] >= rank[static_cast<std::size_t>(c.upper)])
          faults.add(crossing_name(c.crossing), strand_name(c.upper) + " slides across " + strand_name(b) +
                                                    " and must come after it in the order");
    faults.throw_if_any();
    return requested;
  }
  std::vector<std::vector<int>> above(count);
  std::vector<int> unprinted_below(count, 0);
  for (const SlidingCrossing& c : crossings) {
    for (const int b : c.below) {
      above[static_cast<std::size_t>(b)].push_back(c.upper);
      ++unprinted_below[static_cast<std::size_t>(c.upper)];
    }
  }
  using Entry = std::pair<bool, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> ready;
  std::vector<char> lifted(count, 0);
  for (std::size_t s = 0; s < count; ++s) {
    lifted[s] = unprinted_below[s] > 0 ? 1 : 0;
    if (unprinted_below[s] == 0) ready.emplace(false, static_cast<int>(s));
  }
  std::vector<int> order;
  std::vector<char> printed(count, 0);
  order.reserve(count);
  while (!ready.empty()) {
    const int s = ready.top().second;
    ready.pop();
    order.push_back(s);
    printed[static_cast<std::size_t>(s)] = 1;
    for (const int u : above[static_cast<std::size_t>(s)])
      if (--unprinted_below[static_cast<std::size_t>(u)] == 0)
        ready.emplace(lifted[static_cast<std::size_t>(u)] != 0, u);
  }
  if (order.size() < count) refuse_cycle(crossings, printed);
  return order;
}

}  // namespace supple::weave
