#include "supple/weave/layout_warnings.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

namespace supple::weave {
namespace {

constexpr double small_angle = 0.2;  ///< a smaller crossing angle is worth a warning, rad
/// Crossings between two checks for a stop request: a few milliseconds.
constexpr std::size_t warned_crossings_between_checks = 1024;
/// Places of a strand this close to each other, relative to its length, are the same place.
constexpr double same_place_fraction = 1e-6;

/// Counts cases and keeps the first one.
struct Cases {
  std::size_t count = 0;
  std::size_t first = 0;

  void add(std::size_t index) {
    if (count++ == 0) first = index;
  }
};

void add_warning(const Cases& cases, const std::string& finding, const char* subject,
                 std::vector<std::string>& warnings) {
  if (cases.count == 0) return;
  warnings.push_back(std::to_string(cases.count) + " " + subject + " " + finding + "; the first is " +
                     std::to_string(cases.first) + ".");
}

const Strand& strand_of(const Weave& weave, const CrossingMember& member) {
  return weave.strands[static_cast<std::size_t>(member.strand)];
}

/// Disjoint sets of strands that crossings connect (union-find).
class Parts {
 public:
  explicit Parts(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

void warn_of_parts(const Weave& weave, std::vector<std::string>& warnings) {
  Parts parts(weave.strands.size());
  std::vector<bool> crosses(weave.strands.size(), false);
  for (const Crossing& crossing : weave.crossings) {
    for (const CrossingMember& member : crossing.members) {
      crosses[static_cast<std::size_t>(member.strand)] = true;
      parts.join(static_cast<std::size_t>(member.strand), static_cast<std::size_t>(crossing.members.front().strand));
    }
  }
  Cases unconnected;
  std::set<std::size_t> roots;
  for (std::size_t s = 0; s < crosses.size(); ++s) {
    if (crosses[s]) {
      roots.insert(parts.find(s));
    } else {
      unconnected.add(s);
    }
  }
  add_warning(unconnected, "have no crossing: nothing connects them", "strands", warnings);
  if (roots.size() > 1)
    warnings.push_back("The strands with crossings form " + std::to_string(roots.size()) +
                       " parts that nothing connects.");
}

double angle_between(const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
  return std::asin(std::min(1.0, std::abs(u[0] * v[1] - u[1] * v[0])));
}

/// Whether two strands of a crossing meet at a small angle. At most 17 strands are compared, since of 17 lines two
/// always do.
bool has_small_angle(const Weave& weave, const Crossing& crossing) {
  std::vector<Eigen::Vector2d> tangents;
  for (const CrossingMember& member : crossing.members) {
    const Eigen::Vector2d tangent = strand_of(weave, member).curve.at(member.coordinate).first.normalized();
    for (const Eigen::Vector2d& other : tangents)
      if (angle_between(tangent, other) < small_angle) return true;
    tangents.push_back(tangent);
  }
  return false;
}

void warn_of_angles(const Weave& weave, const Execution& execution, std::vector<std::string>& warnings) {
  Cases at_small_angles;
  for (std::size_t c = 0; c < weave.crossings.size(); ++c) {
    if (c % warned_crossings_between_checks == 0) execution.cancellation.throw_if_requested();
    if (has_small_angle(weave, weave.crossings[c])) at_small_angles.add(c);
  }
  add_warning(at_small_angles, "have strands that meet at less than 0.2 rad", "crossings", warnings);
}

/// Coordinates of crossings on every strand, ascending, with the crossings' indices.
std::vector<std::vector<std::pair<double, std::size_t>>> places_of(const Weave& weave) {
  std::vector<std::vector<std::pair<double, std::size_t>>> places(weave.strands.size());
  for (std::size_t c = 0; c < weave.crossings.size(); ++c)
    for (const CrossingMember& member : weave.crossings[c].members)
      places[static_cast<std::size_t>(member.strand)].emplace_back(member.coordinate, c);
  for (auto& list : places) std::sort(list.begin(), list.end());
  return places;
}

void warn_of_distances(const Weave& weave, std::vector<std::string>& warnings) {
  const auto places = places_of(weave);
  std::set<std::size_t> near;
  for (std::size_t s = 0; s < places.size(); ++s) {
    const auto& list = places[s];
    const double diameter = 2 * weave.strands[s].radius;
    for (std::size_t i = 1; i < list.size(); ++i)
      if (list[i].first - list[i - 1].first < diameter) near.insert(list[i - 1].second);
    if (weave.strands[s].curve.ends() != Ends::open && list.size() > 1 &&
        list.front().first + weave.strands[s].curve.length() - list.back().first < diameter)
      near.insert(list.back().second);
  }
  add_warning({near.size(), near.empty() ? 0 : *near.begin()},
              "lie closer to the next one of a strand than its diameter", "crossings", warnings);
}

void warn_of_missing_crossings(const Weave& weave, const Execution& execution, std::vector<std::string>& warnings) {
  const auto places = places_of(weave);
  const auto is_place = [&](const CrossingMember& member) {
    const auto& list = places[static_cast<std::size_t>(member.strand)];
    const double length = strand_of(weave, member).curve.length();
    const double near = same_place_fraction * length;
    const auto is_near = [&](double coordinate) {
      const auto next = std::lower_bound(list.begin(), list.end(), std::pair(coordinate - near, std::size_t{0}));
      return next != list.end() && next->first <= coordinate + near;
    };
    if (is_near(member.coordinate)) return true;
    const bool loop = strand_of(weave, member).curve.ends() != Ends::open;
    return loop && (is_near(member.coordinate - length) || is_near(member.coordinate + length));
  };
  Cases missing;
  for (const Crossing& found : find_crossings(weave.strands, weave.lattice, execution))
    if (!std::all_of(found.members.begin(), found.members.end(), is_place))
      missing.add(static_cast<std::size_t>(found.members.front().strand));
  if (missing.count > 0)
    warnings.push_back("Strands cross at " + std::to_string(missing.count) +
                       " places without a crossing; the first is on strand " + std::to_string(missing.first) + ".");
}

}  // namespace

std::vector<std::string> layout_warnings(const Weave& weave, const Execution& execution) {
  std::vector<std::string> warnings;
  execution.cancellation.throw_if_requested();
  warn_of_parts(weave, warnings);
  warn_of_missing_crossings(weave, execution, warnings);
  warn_of_angles(weave, execution, warnings);
  execution.cancellation.throw_if_requested();
  warn_of_distances(weave, warnings);
  return warnings;
}

}  // namespace supple::weave
