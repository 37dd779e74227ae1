#include "polygon_sides.h"

#include <algorithm>
#include <cmath>

#include "planar_cross.h"

namespace supple::voronoi {

using Eigen::Vector2d;

Side reversed(const Side& side) {
  Side result{side.to, side.from, side.cuts, side.fractions, side.sites};
  std::reverse(result.cuts.begin(), result.cuts.end());
  std::reverse(result.fractions.begin(), result.fractions.end());
  std::reverse(result.sites.begin(), result.sites.end());
  for (double& fraction : result.fractions) fraction = 1 - fraction;
  return result;
}

std::pair<Side, Side> split(const Side& side, double at) {
  const Vector2d middle = side.from + at * (side.to - side.from);
  Side first{side.from, middle, {}, {}, {}};
  Side second{middle, side.to, {}, {}, {}};
  const auto before = static_cast<std::size_t>(std::upper_bound(side.fractions.begin(), side.fractions.end(), at) -
                                               side.fractions.begin());
  for (std::size_t i = 0; i < side.fractions.size(); ++i) {
    Side& part = i < before ? first : second;
    part.cuts.push_back(side.cuts[i]);
    part.fractions.push_back(i < before ? side.fractions[i] / at : (side.fractions[i] - at) / (1 - at));
  }
  first.sites.assign(side.sites.begin(), side.sites.begin() + static_cast<std::ptrdiff_t>(before) + 1);
  second.sites.assign(side.sites.begin() + static_cast<std::ptrdiff_t>(before), side.sites.end());
  return {first, second};
}

bool choose_chord(const Sides& sides, BoundaryPlace& begin, BoundaryPlace& end) {
  struct Arc {
    std::int32_t site;
    BoundaryPlace middle;  ///< middle of its longest part on one side
    double length = -1;
  };
  std::vector<Arc> arcs;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Side& side = sides[k];
    const double length = (side.to - side.from).norm();
    double before = 0;
    for (std::size_t i = 0; i < side.sites.size(); ++i) {
      const double after = i < side.fractions.size() ? side.fractions[i] : 1;
      if (arcs.empty() || i > 0) arcs.push_back({side.sites[i], {}});
      Arc& arc = arcs.back();
      if ((after - before) * length > arc.length) {
        arc.length = (after - before) * length;
        arc.middle = {k, 0.5 * (before + after)};
      }
      before = after;
    }
  }
  if (arcs.size() > 1 && arcs.front().site == arcs.back().site) {
    if (arcs.back().length > arcs.front().length) arcs.front() = arcs.back();
    arcs.pop_back();
  }
  const Arc* first = nullptr;
  const Arc* second = nullptr;
  bool of_one_site = false;
  std::size_t best_arc_count = 0;  // smaller one of the numbers of arcs on the two sides of the chord
  double best = 0;
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    for (std::size_t j = i + 2; j < arcs.size() && j - i + 1 < arcs.size(); ++j) {
      if (arcs[i].middle.side == arcs[j].middle.side) continue;
      const bool same = arcs[i].site == arcs[j].site;
      const std::size_t arc_count = std::min(j - i, arcs.size() - (j - i));
      const double length = std::min(arcs[i].length, arcs[j].length);
      if (!(length > 0) || (of_one_site && !same)) continue;
      // Chords between arcs of one site are preferred, and among them those that divide the arcs most evenly.
      if (same == of_one_site &&
          (same ? std::pair(arc_count, length) <= std::pair(best_arc_count, best) : length <= best))
        continue;
      of_one_site = same;
      best_arc_count = arc_count;
      best = length;
      first = &arcs[i];
      second = &arcs[j];
    }
  }
  if (first == nullptr) return false;
  begin = first->middle;
  end = second->middle;
  if (end.side < begin.side) std::swap(begin, end);
  return true;
}

void choose_middle_chord(const Sides& sides, double longest, BoundaryPlace& begin, BoundaryPlace& end) {
  begin = {0, 0.5};
  while ((sides[begin.side].to - sides[begin.side].from).norm() < longest) ++begin.side;
  double best = -1;
  const Vector2d from = 0.5 * (sides[begin.side].from + sides[begin.side].to);
  for (std::size_t k = 1; k < sides.size(); ++k) {
    const std::size_t side = (begin.side + k) % sides.size();
    const double height = std::min(std::abs(cross(sides[begin.side].to - sides[begin.side].from,
                                                  0.5 * (sides[side].from + sides[side].to) - from)),
                                   longest * longest);
    if (!(height > best)) continue;
    best = height;
    end = {side, 0.5};
  }
  if (end.side < begin.side) std::swap(begin, end);
}

}  // namespace supple::voronoi
