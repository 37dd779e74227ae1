#include "supple/weave/places.h"

#include <array>

namespace supple::weave {

StrandPlace place_of(const Crossing& crossing) {
  for (const auto& member : crossing.members)
    if (!member.slides) return {member.strand, member.coordinate};
  return {crossing.members.front().strand, crossing.members.front().coordinate};
}

std::vector<StrandPlace> places_in(const Weave& weave, const Eigen::Vector2d& lower, const Eigen::Vector2d& upper) {
  // An end within this fraction of its strand's length from a crossing belongs to the crossing.
  constexpr double same_place_tolerance = 1e-6;
  const auto inside = [&](const Eigen::Vector2d& at) {
    return (at.array() >= lower.array()).all() && (at.array() <= upper.array()).all();
  };
  std::vector<StrandPlace> places;
  std::vector<std::array<bool, 2>> crossed(weave.strands.size(), {false, false});
  for (const auto& crossing : weave.crossings) {
    for (const auto& member : crossing.members) {
      const auto s = static_cast<std::size_t>(member.strand);
      const double length = weave.strands[s].curve.length();
      if (member.coordinate <= same_place_tolerance * length) crossed[s][0] = true;
      if (member.coordinate >= length - same_place_tolerance * length) crossed[s][1] = true;
    }
    if (inside(rest_position(weave, crossing.members.front()))) places.push_back(place_of(crossing));
  }
  for (std::size_t s = 0; s < weave.strands.size(); ++s) {
    const auto& curve = weave.strands[s].curve;
    if (curve.ends() != Ends::open) continue;
    const std::array<double, 2> ends{0, curve.length()};
    for (std::size_t end = 0; end < 2; ++end)
      if (!crossed[s][end] && inside(curve.at(ends[end]).position)) places.push_back({static_cast<int>(s), ends[end]});
  }
  return places;
}

}  // namespace supple::weave
