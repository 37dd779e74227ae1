#include "strand_path.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace supple::weave {
namespace {

/// Lifts rise by at most this much for each millimetre along the strand.
constexpr double steepest = 4;
/// Coordinates closer than this are one, mm: shorter segments are below the resolution of printers.
constexpr double same_place = 1e-3;

/// A stretch of a strand.
struct Stretch {
  double begin = 0;
  double end = 0;
};

/// Where a strand is up: rises from `begin`, is up from `up` to `down`, and has come down at `end`.
struct Raised {
  double begin, up, down, end;
};

/// What happens on one strand.
struct Strip {
  struct Over {
    double at, top;
    int crossing;
  };
  std::vector<Over> over;     ///< crossings where it is the upper one
  std::vector<Stretch> flat;  ///< where it must lie on the bed
};

std::vector<Strip> strips(const Weave& weave, const std::vector<SlidingCrossing>& crossings,
                          const PrinterProfile& profile) {
  std::vector<Strip> result(weave.strands.size());
  std::vector<char> slides(weave.crossings.size(), 0);
  for (const SlidingCrossing& c : crossings) {
    slides[static_cast<std::size_t>(c.crossing)] = 1;
    result[static_cast<std::size_t>(c.upper)].over.push_back({c.upper_at, profile.lift.top / c.least_sine, c.crossing});
  }
  for (std::size_t c = 0; c < weave.crossings.size(); ++c) {
    for (const CrossingMember& m : weave.crossings[c].members) {
      if (m.slides) continue;
      const double half =
          slides[c] != 0 ? channel_reach(profile.channel) : weave.strands[static_cast<std::size_t>(m.strand)].radius;
      result[static_cast<std::size_t>(m.strand)].flat.push_back({m.coordinate - half, m.coordinate + half});
    }
  }
  for (std::size_t s = 0; s < result.size(); ++s) {
    Strip& strip = result[s];
    const Strand& strand = weave.strands[s];
    if (strand.curve.ends() == Ends::open)
      for (const double end : {0.0, strand.curve.length()})
        strip.flat.push_back({end - strand.radius, end + strand.radius});
    std::sort(strip.over.begin(), strip.over.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
    std::sort(strip.flat.begin(), strip.flat.end(),
              [](const Stretch& a, const Stretch& b) { return a.begin < b.begin; });
  }
  return result;
}

/// How far `at` is from the nearest flat stretches before and after it, around loops; a crossing within one has no
/// room.
Stretch room(const Strip& strip, double at, double length, bool closed) {
  Stretch found{length, length};
  for (const Stretch& flat : strip.flat) {
    for (const double turn : {-length, 0.0, length}) {
      if (!closed && turn != 0) continue;
      const double middle = (flat.begin + flat.end) / 2 + turn;
      if (middle < at) found.begin = std::min(found.begin, at - (flat.end + turn));
      if (middle >= at) found.end = std::min(found.end, flat.begin + turn - at);
    }
  }
  return found;
}

std::vector<Raised> raised(int number, const Strip& strip, double length, bool closed, const Lift& lift,
                           const Execution& execution, PrintFaults& faults) {
  std::vector<Raised> result;
  result.reserve(strip.over.size());
  for (const Strip::Over& over : strip.over) {
    execution.cancellation.throw_if_requested();
    const Stretch free = room(strip, over.at, length, closed);
    const double least = over.top + lift.height / steepest;
    if (std::min(free.begin, free.end) < least) {
      faults.add(crossing_name(over.crossing),
                 strand_name(number) + " must be lifted " + mm(least) + " before and after it and has " +
                     mm(std::max(0.0, std::min(free.begin, free.end))) +
                     " to where it lies on the bed: an end, a fused crossing or another channel");
      continue;
    }
    const double run = std::max(lift.run, least);
    result.push_back({over.at - std::min(run, free.begin), over.at - over.top, over.at + over.top,
                      over.at + std::min(run, free.end)});
  }
  return result;
}

bool must_land_between(const Strip& strip, double from, double to, double length, bool closed) {
  return std::any_of(strip.flat.begin(), strip.flat.end(), [&](const Stretch& flat) {
    const double middle = (flat.begin + flat.end) / 2;
    return (middle > from && middle < to) || (closed && middle + length > from && middle + length < to);
  });
}

/// Joins lifts between which the strand would not come down for long.
std::vector<Raised> bridged(const std::vector<Raised>& lifts, const Strip& strip, double bridge, double length,
                            bool closed, const Execution& execution) {
  std::vector<Raised> result;
  for (const Raised& next : lifts) {
    execution.cancellation.throw_if_requested();
    if (!result.empty() && next.begin - result.back().end < bridge &&
        !must_land_between(strip, result.back().down, next.up, length, closed)) {
      result.back().down = next.down;
      result.back().end = next.end;
    } else {
      result.push_back(next);
    }
  }
  return result;
}

/// The lifts of a loop from a place on, where it lies on the bed: in the middle of the longest such stretch. Its end
/// is printed on over its beginning by `overlap`.
double unroll(int number, std::vector<Raised>& lifts, double length, double overlap, PrintFaults& faults) {
  if (lifts.empty()) return 0;
  std::size_t last = 0;
  double longest = -length;
  for (std::size_t i = 0; i < lifts.size(); ++i) {
    const double next = i + 1 < lifts.size() ? lifts[i + 1].begin : lifts[0].begin + length;
    if (next - lifts[i].end > longest) {
      longest = next - lifts[i].end;
      last = i;
    }
  }
  const double least = std::max(2 * overlap, same_place);
  if (longest < least) {
    faults.add(strand_name(number), "is a loop that needs " + mm(least) +
                                        " on the bed, where it begins and ends, and has " + mm(std::max(0.0, longest)) +
                                        " between its lifts");
    return 0;
  }
  const double start = lifts[last].end + longest / 2;
  std::rotate(lifts.begin(), lifts.begin() + static_cast<std::ptrdiff_t>(last) + 1, lifts.end());
  for (Raised& r : lifts) {
    const double turns = length * std::ceil((start - r.begin) / length);
    r = {r.begin + turns, r.up + turns, r.down + turns, r.end + turns};
  }
  return start;
}

double height(const std::vector<Raised>& lifts, double s, double top) {
  for (const Raised& r : lifts) {
    if (s <= r.begin || s >= r.end) continue;
    if (s < r.up) return top * (s - r.begin) / (r.up - r.begin);
    if (s > r.down) return top * (r.end - s) / (r.end - r.down);
    return top;
  }
  return 0;
}

/// Coordinates between which the curve leaves its chords by less than the error, within [from, to].
std::vector<double> sampled(const StrandCurve& curve, double from, double to, double error,
                            const Execution& execution) {
  std::vector<double> result{from, to};
  if (curve.straight()) return result;
  const std::vector<double>& knots = curve.knots();
  const double length = curve.length();
  const int turns = curve.ends() == Ends::closed ? static_cast<int>(std::ceil(to / length)) : 1;
  for (int turn = 0; turn < turns; ++turn) {
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      execution.cancellation.throw_if_requested();
      const double h = knots[i + 1] - knots[i];
      const double bend = std::max(curve.at(knots[i]).second.norm(), curve.at(knots[i] + h / 2).second.norm());
      // A chord over a length h of curvature k is left by h^2 k / 8.
      const int pieces = std::max(1, static_cast<int>(std::ceil(h * std::sqrt(bend / (8 * error)))));
      for (int p = 0; p < pieces; ++p) {
        const double s = turn * length + knots[i] + h * p / pieces;
        if (s > from && s < to) result.push_back(s);
      }
    }
  }
  return result;
}

StrandPath path_of(const StrandCurve& curve, double from, double to, const std::vector<Raised>& lifts,
                   const PrinterProfile& profile, double error, const Execution& execution) {
  std::vector<double> places = sampled(curve, from, to, error, execution);
  for (const Raised& r : lifts)
    for (const double s : {r.begin, r.up, r.down, r.end})
      if (s > from && s < to) places.push_back(s);
  std::sort(places.begin(), places.end());
  StrandPath path;
  double last = 0;
  for (const double s : places) {
    execution.cancellation.throw_if_requested();
    // The end itself is always there: it is where a loop meets its beginning.
    if (!path.points.empty() && (s - last < same_place || (s < to && to - s < same_place))) continue;
    const Eigen::Vector2d at = curve.at(s).position;
    if (!path.points.empty()) path.lifted.push_back(height(lifts, (s + last) / 2, profile.lift.height) > 0 ? 1 : 0);
    path.points.emplace_back(at[0], at[1], profile.strand_height + height(lifts, s, profile.lift.height));
    last = s;
  }
  return path;
}

}  // namespace

double channel_reach(const Channel& channel) { return channel.half_width * (1 + channel.longer); }

std::vector<StrandPath> strand_paths(const Weave& weave, const std::vector<SlidingCrossing>& crossings,
                                     const PrinterProfile& profile, const ToolpathOptions& options,
                                     const std::vector<Overrun>& overruns, const Execution& execution,
                                     PrintFaults& faults) {
  const std::vector<Strip> all = strips(weave, crossings, profile);
  std::vector<StrandPath> paths;
  paths.reserve(all.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    const StrandCurve& curve = weave.strands[s].curve;
    const auto number = static_cast<int>(s);
    const double length = curve.length();
    const bool closed = curve.ends() == Ends::closed;
    std::vector<Raised> lifts = raised(number, all[s], length, closed, profile.lift, execution, faults);
    const double start = closed ? unroll(number, lifts, length, options.loop_overlap, faults) : -overruns[s].start;
    lifts = bridged(lifts, all[s], profile.lift.bridge, length, closed, execution);
    const double end = closed ? start + length + options.loop_overlap : length + overruns[s].end;
    paths.push_back(path_of(curve, start, end, lifts, profile, options.chord_error, execution));
  }
  return paths;
}

}  // namespace supple::weave
