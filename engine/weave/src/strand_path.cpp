#include "strand_path.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace supple::weave {
namespace {

/// Maximum slope of a lift: its rise for each millimetre along the strand.
constexpr double max_slope = 4;
/// Minimum distance of two coordinates, mm. Shorter segments are below the resolution of printers.
constexpr double min_spacing = 1e-3;

/// An interval of a strand's coordinate, mm.
struct Interval {
  double begin = 0;
  double end = 0;
};

/// A lift. It rises from `begin`, is up from `up` to `down`, and has come down at `end`; coordinates in mm.
struct RaisedInterval {
  double begin, up, down, end;
};

/// Where one strand must be lifted and where it must lie on the bed.
struct HeightConstraints {
  /// Coordinate of a crossing above which the strand is lifted, half the length of the top (mm), and the crossing's
  /// number.
  struct LiftedCrossing {
    double at, top;
    int crossing;
  };
  std::vector<LiftedCrossing> lifted_crossings;  ///< crossings at which it is the upper strand
  std::vector<Interval> flat;                    ///< intervals in which it must lie on the bed
};

std::vector<HeightConstraints> height_constraints(const Weave& weave, const std::vector<SlidingCrossing>& crossings,
                                                  const PrinterProfile& profile) {
  std::vector<HeightConstraints> result(weave.strands.size());
  std::vector<char> slides(weave.crossings.size(), 0);
  for (const SlidingCrossing& c : crossings) {
    slides[static_cast<std::size_t>(c.crossing)] = 1;
    result[static_cast<std::size_t>(c.upper)].lifted_crossings.push_back(
        {c.upper_coordinate, profile.lift.top / c.min_sine, c.crossing});
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
    HeightConstraints& constraints = result[s];
    const Strand& strand = weave.strands[s];
    if (strand.curve.ends() == Ends::open)
      for (const double end : {0.0, strand.curve.length()})
        constraints.flat.push_back({end - strand.radius, end + strand.radius});
    std::sort(constraints.lifted_crossings.begin(), constraints.lifted_crossings.end(),
              [](const auto& a, const auto& b) { return a.at < b.at; });
    std::sort(constraints.flat.begin(), constraints.flat.end(),
              [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
  }
  return result;
}

/// The distances from `at` to the nearest flat intervals before and after it, also across the seam of a loop. They are
/// negative within a flat interval, where there is no room.
Interval free_distances(const HeightConstraints& constraints, double at, double length, bool closed) {
  Interval found{length, length};
  for (const Interval& flat : constraints.flat) {
    for (const double period : {-length, 0.0, length}) {
      if (!closed && period != 0) continue;
      const double middle = (flat.begin + flat.end) / 2 + period;
      if (middle < at) found.begin = std::min(found.begin, at - (flat.end + period));
      if (middle >= at) found.end = std::min(found.end, flat.begin + period - at);
    }
  }
  return found;
}

std::vector<RaisedInterval> lifts_over_crossings(int number, const HeightConstraints& constraints, double length,
                                                 bool closed, const Lift& lift, const Execution& execution,
                                                 PrintFaults& faults) {
  std::vector<RaisedInterval> result;
  result.reserve(constraints.lifted_crossings.size());
  for (const HeightConstraints::LiftedCrossing& lifted : constraints.lifted_crossings) {
    execution.cancellation.throw_if_requested();
    const Interval free = free_distances(constraints, lifted.at, length, closed);
    const double min_distance = lifted.top + lift.height / max_slope;
    if (std::min(free.begin, free.end) < min_distance) {
      const double available = std::max(0.0, std::min(free.begin, free.end));
      faults.add(crossing_name(lifted.crossing),
                 strand_name(number) + " must be lifted " + mm(min_distance) + " before and after it and has " +
                     mm(available) + " to where it lies on the bed: an end, a fused crossing or another channel",
                 Error::Shortage{min_distance, available});
      continue;
    }
    const double run = std::max(lift.run, min_distance);
    result.push_back({lifted.at - std::min(run, free.begin), lifted.at - lifted.top, lifted.at + lifted.top,
                      lifted.at + std::min(run, free.end)});
  }
  return result;
}

bool must_land_between(const HeightConstraints& constraints, double from, double to, double length, bool closed) {
  return std::any_of(constraints.flat.begin(), constraints.flat.end(), [&](const Interval& flat) {
    const double middle = (flat.begin + flat.end) / 2;
    return (middle > from && middle < to) || (closed && middle + length > from && middle + length < to);
  });
}

/// Joins neighbouring lifts if the strand would come down between them for less than `bridge`.
std::vector<RaisedInterval> join_near_lifts(const std::vector<RaisedInterval>& lifts,
                                            const HeightConstraints& constraints, double bridge, double length,
                                            bool closed, const Execution& execution) {
  std::vector<RaisedInterval> result;
  for (const RaisedInterval& next : lifts) {
    execution.cancellation.throw_if_requested();
    if (!result.empty() && next.begin - result.back().end < bridge &&
        !must_land_between(constraints, result.back().down, next.up, length, closed)) {
      result.back().down = next.down;
      result.back().end = next.end;
    } else {
      result.push_back(next);
    }
  }
  return result;
}

/// Chooses where the printing of a loop starts: in the middle of the longest interval on the bed between its lifts.
/// Sorts the lifts from that coordinate on and returns it. The loop's end overlaps its beginning by `overlap`.
double choose_loop_start(int number, std::vector<RaisedInterval>& lifts, double length, double overlap,
                         PrintFaults& faults) {
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
  const double min_distance = std::max(2 * overlap, min_spacing);
  if (longest < min_distance) {
    faults.add(strand_name(number), "is a loop that needs " + mm(min_distance) +
                                        " on the bed, where it begins and ends, and has " + mm(std::max(0.0, longest)) +
                                        " between its lifts");
    return 0;
  }
  const double start = lifts[last].end + longest / 2;
  std::rotate(lifts.begin(), lifts.begin() + static_cast<std::ptrdiff_t>(last) + 1, lifts.end());
  for (RaisedInterval& r : lifts) {
    const double periods = length * std::ceil((start - r.begin) / length);
    r = {r.begin + periods, r.up + periods, r.down + periods, r.end + periods};
  }
  return start;
}

double height(const std::vector<RaisedInterval>& lifts, double s, double top) {
  for (const RaisedInterval& r : lifts) {
    if (s <= r.begin || s >= r.end) continue;
    if (s < r.up) return top * (s - r.begin) / (r.up - r.begin);
    if (s > r.down) return top * (r.end - s) / (r.end - r.down);
    return top;
  }
  return 0;
}

/// Coordinates within [from, to] between which the chords are closer to the curve than the error.
std::vector<double> sample_coordinates(const StrandCurve& curve, double from, double to, double error,
                                       const Execution& execution) {
  std::vector<double> result{from, to};
  if (curve.straight()) return result;
  const std::vector<double>& knots = curve.knots();
  const double length = curve.length();
  const int periods = curve.ends() == Ends::closed ? static_cast<int>(std::ceil(to / length)) : 1;
  for (int period = 0; period < periods; ++period) {
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      execution.cancellation.throw_if_requested();
      const double h = knots[i + 1] - knots[i];
      const double curvature = std::max(curve.at(knots[i]).second.norm(), curve.at(knots[i] + h / 2).second.norm());
      // The distance of a chord from an arc of length h and curvature k is h^2 k / 8.
      const int pieces = std::max(1, static_cast<int>(std::ceil(h * std::sqrt(curvature / (8 * error)))));
      for (int p = 0; p < pieces; ++p) {
        const double s = period * length + knots[i] + h * p / pieces;
        if (s > from && s < to) result.push_back(s);
      }
    }
  }
  return result;
}

StrandPath path_of(const StrandCurve& curve, double from, double to, const std::vector<RaisedInterval>& lifts,
                   const PrinterProfile& profile, double error, const Execution& execution) {
  std::vector<double> places = sample_coordinates(curve, from, to, error, execution);
  for (const RaisedInterval& r : lifts)
    for (const double s : {r.begin, r.up, r.down, r.end})
      if (s > from && s < to) places.push_back(s);
  std::sort(places.begin(), places.end());
  StrandPath path;
  double last = 0;
  for (const double s : places) {
    execution.cancellation.throw_if_requested();
    // The end is always included, since a loop meets its beginning there.
    if (!path.points.empty() && (s - last < min_spacing || (s < to && to - s < min_spacing))) continue;
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
  const std::vector<HeightConstraints> constraints_of_strands = height_constraints(weave, crossings, profile);
  std::vector<StrandPath> paths;
  paths.reserve(constraints_of_strands.size());
  for (std::size_t s = 0; s < constraints_of_strands.size(); ++s) {
    const StrandCurve& curve = weave.strands[s].curve;
    const auto number = static_cast<int>(s);
    const double length = curve.length();
    const bool closed = curve.ends() == Ends::closed;
    std::vector<RaisedInterval> lifts =
        lifts_over_crossings(number, constraints_of_strands[s], length, closed, profile.lift, execution, faults);
    const double start =
        closed ? choose_loop_start(number, lifts, length, options.loop_overlap, faults) : -overruns[s].start;
    lifts = join_near_lifts(lifts, constraints_of_strands[s], profile.lift.bridge, length, closed, execution);
    const double end = closed ? start + length + options.loop_overlap : length + overruns[s].end;
    paths.push_back(path_of(curve, start, end, lifts, profile, options.chord_error, execution));
  }
  return paths;
}

}  // namespace supple::weave
