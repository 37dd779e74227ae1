#include "channel_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

namespace supple::weave {
namespace {

constexpr int arc_pieces = 8;  ///< number of line segments in each half of an arc

/// The height of a channel over its feet at a distance from the apex. The foot is at the distance `half`. All in mm.
double height(const Channel& channel, double distance, double half) {
  const double fraction = std::min(1.0, distance / half);
  return channel.shape == ChannelShape::triangle ? channel.apex * (1 - fraction)
                                                 : channel.apex * std::cos(std::numbers::pi / 2 * fraction);
}

/// A strand that slides across another one. No foot may touch it.
struct StrandSlider {
  double coordinate;  ///< coordinate on the strand below, mm
  double half_width;  ///< half of its width along the strand below, mm
  int crossing;
};

std::vector<std::vector<StrandSlider>> sliders(const Weave& weave, const std::vector<SlidingCrossing>& crossings) {
  std::vector<std::vector<StrandSlider>> result(weave.strands.size());
  for (const SlidingCrossing& c : crossings)
    result[static_cast<std::size_t>(c.bottom)].push_back(
        {c.bottom_coordinate, weave.strands[static_cast<std::size_t>(c.upper)].radius / c.sine, c.crossing});
  for (auto& list : result)
    std::sort(list.begin(), list.end(),
              [](const StrandSlider& a, const StrandSlider& b) { return a.coordinate < b.coordinate; });
  return result;
}

/// Maximum distance of a foot from its crossing, mm, and what limits it.
struct Reach {
  double distance = std::numeric_limits<double>::infinity();
  std::string limit{};
};

class Feet {
 public:
  Feet(const Weave& weave, const std::vector<SlidingCrossing>& crossings, const std::vector<Overrun>& overruns)
      : weave_(weave), sliders_(sliders(weave, crossings)), overruns_(overruns) {}

  Reach reach(const SlidingCrossing& crossing, double direction) const {
    const auto bottom = static_cast<std::size_t>(crossing.bottom);
    const Strand& strand = weave_.strands[bottom];
    const double length = strand.curve.length();
    const bool closed = strand.curve.ends() == Ends::closed;
    Reach result;
    if (!closed) {
      result.distance = direction < 0 ? crossing.bottom_coordinate + overruns_[bottom].start
                                      : length + overruns_[bottom].end - crossing.bottom_coordinate;
      result.limit = "the end of " + strand_name(crossing.bottom);
    }
    for (const StrandSlider& other : sliders_[bottom]) {
      if (other.crossing == crossing.crossing) continue;
      double ahead = direction * (other.coordinate - crossing.bottom_coordinate);
      if (ahead < 0 && closed) ahead += length;
      // A foot is as wide as the strand on which it stands.
      const double distance = ahead - other.half_width - strand.radius;
      if (ahead >= 0 && distance < result.distance)
        result = {distance, "the strand that slides at " + crossing_name(other.crossing)};
    }
    return result;
  }

 private:
  const Weave& weave_;
  std::vector<std::vector<StrandSlider>> sliders_;
  const std::vector<Overrun>& overruns_;
};

/// Checks that a channel clears the strand inside it: at the strand's sides, its underside must be above the strand's
/// top.
void check_clearance(const Weave& weave, const SlidingCrossing& crossing, const PrinterProfile& profile,
                     PrintFaults& faults) {
  const Channel& channel = profile.channel;
  const double radius = weave.strands[static_cast<std::size_t>(crossing.upper)].radius;
  const double side = radius / crossing.sine;
  if (side >= channel.half_width) {
    faults.add(crossing_name(crossing.crossing), "the strand takes up " + mm(side) +
                                                     " to either side along the one below: channel/half_width must be "
                                                     "larger, is " +
                                                     mm(channel.half_width));
    return;
  }
  const double bottom_radius = weave.strands[static_cast<std::size_t>(crossing.bottom)].radius;
  // The thickness is the diameter of a round bead of the channel's area.
  const double thickness = 2 * std::sqrt(profile.channel_flow * bead_area(profile, bottom_radius) / std::numbers::pi);
  const double shape = height(channel, side, channel.half_width) / channel.apex;
  const double min_apex = (profile.lift.height + thickness) / shape;
  if (channel.apex < min_apex)
    faults.add(crossing_name(crossing.crossing),
               "the channel would touch the strand within: channel/apex must be at least " + mm(min_apex) +
                   " for a lift of " + mm(profile.lift.height) + ", is " + mm(channel.apex));
}

std::vector<Eigen::Vector3d> polyline(const StrandCurve& curve, double at, double direction,
                                      const PrinterProfile& profile) {
  const Channel& channel = profile.channel;
  const double first = channel.half_width;
  const double second = first * (1 + channel.longer);
  const auto position = [&](double s) -> Eigen::Vector2d { return curve.at(at + direction * s).position; };
  const Eigen::Vector2d centre = position(0);
  std::vector<Eigen::Vector3d> points;
  const int pieces = channel.shape == ChannelShape::triangle ? 1 : arc_pieces;
  // The points lie above the chords from the feet to the crossing, because a bead under tension follows them.
  const auto add = [&](double half, double foot, double fraction) {
    const Eigen::Vector2d p = centre + fraction * (position(foot) - centre);
    points.emplace_back(p[0], p[1], profile.strand_height + height(channel, fraction * half, half));
  };
  for (int i = 0; i <= pieces; ++i) add(first, -first, 1 - static_cast<double>(i) / pieces);
  for (int i = 1; i <= pieces; ++i) add(second, second, static_cast<double>(i) / pieces);
  return points;
}

}  // namespace

std::vector<std::vector<Eigen::Vector3d>> channel_paths(const Weave& weave,
                                                        const std::vector<SlidingCrossing>& crossings,
                                                        const PrinterProfile& profile,
                                                        const std::vector<Overrun>& overruns,
                                                        const Execution& execution, PrintFaults& faults) {
  const Feet feet(weave, crossings, overruns);
  const double first = profile.channel.half_width;
  const double second = first * (1 + profile.channel.longer);
  std::vector<std::vector<Eigen::Vector3d>> paths;
  paths.reserve(crossings.size());
  for (const SlidingCrossing& crossing : crossings) {
    execution.cancellation.throw_if_requested();
    check_clearance(weave, crossing, profile, faults);
    const Reach back = feet.reach(crossing, -1);
    const Reach ahead = feet.reach(crossing, 1);
    const bool forwards = back.distance >= first && ahead.distance >= second;
    const bool backwards = back.distance >= second && ahead.distance >= first;
    if (!forwards && !backwards) {
      const Reach& nearer = back.distance < ahead.distance ? back : ahead;
      const double available = std::max(0.0, nearer.distance);
      faults.add(crossing_name(crossing.crossing),
                 "a channel needs " + mm(first) + " and " + mm(second) + " for its feet, and there are " +
                     mm(available) + " to " + nearer.limit,
                 Error::Shortage{second, available});
    }
    paths.push_back(polyline(weave.strands[static_cast<std::size_t>(crossing.bottom)].curve, crossing.bottom_coordinate,
                             forwards ? 1 : -1, profile));
  }
  return paths;
}

}  // namespace supple::weave
