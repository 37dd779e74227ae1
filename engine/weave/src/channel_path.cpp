#include "channel_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

namespace supple::weave {
namespace {

constexpr int arc_pieces = 8;  ///< of each half of an arc

/// The height over the feet at a distance from the apex; `half` is where the foot is.
double height(const Channel& channel, double distance, double half) {
  const double share = std::min(1.0, distance / half);
  return channel.shape == ChannelShape::triangle ? channel.apex * (1 - share)
                                                 : channel.apex * std::cos(std::numbers::pi / 2 * share);
}

/// Strands that slide across each strand: what no foot may touch.
struct StrandSlider {
  double at;
  double half;  ///< of its width along the strand below
  int crossing;
};

std::vector<std::vector<StrandSlider>> sliders(const Weave& weave, const std::vector<SlidingCrossing>& crossings) {
  std::vector<std::vector<StrandSlider>> result(weave.strands.size());
  for (const SlidingCrossing& c : crossings)
    result[static_cast<std::size_t>(c.bottom)].push_back(
        {c.bottom_at, weave.strands[static_cast<std::size_t>(c.upper)].radius / c.sine, c.crossing});
  for (auto& list : result)
    std::sort(list.begin(), list.end(), [](const StrandSlider& a, const StrandSlider& b) { return a.at < b.at; });
  return result;
}

/// How far a foot may be from the crossing, and what is there.
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
      result.distance = direction < 0 ? crossing.bottom_at + overruns_[bottom].start
                                      : length + overruns_[bottom].end - crossing.bottom_at;
      result.limit = "the end of " + strand_name(crossing.bottom);
    }
    for (const StrandSlider& other : sliders_[bottom]) {
      if (other.crossing == crossing.crossing) continue;
      double ahead = direction * (other.at - crossing.bottom_at);
      if (ahead < 0 && closed) ahead += length;
      // The foot is as wide as the strand that it stands on.
      const double distance = ahead - other.half - strand.radius;
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

/// The channel's underside where the strand's side is, against the strand's upper side.
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
  // As thick as a round bead of the channel's area.
  const double thickness = 2 * std::sqrt(profile.channel_flow * bead_area(profile, bottom_radius) / std::numbers::pi);
  const double shape = height(channel, side, channel.half_width) / channel.apex;
  const double least = (profile.lift.height + thickness) / shape;
  if (channel.apex < least)
    faults.add(crossing_name(crossing.crossing),
               "the channel would touch the strand within: channel/apex must be at least " + mm(least) +
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
  // Straight above the chords from foot to crossing: that is where a bead under tension goes.
  const auto add = [&](double half, double foot, double share) {
    const Eigen::Vector2d p = centre + share * (position(foot) - centre);
    points.emplace_back(p[0], p[1], profile.strand_height + height(channel, share * half, half));
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
      faults.add(crossing_name(crossing.crossing), "a channel needs " + mm(first) + " and " + mm(second) +
                                                       " for its feet, and there are " +
                                                       mm(std::max(0.0, nearer.distance)) + " to " + nearer.limit);
    }
    paths.push_back(polyline(weave.strands[static_cast<std::size_t>(crossing.bottom)].curve, crossing.bottom_at,
                             forwards ? 1 : -1, profile));
  }
  return paths;
}

}  // namespace supple::weave
