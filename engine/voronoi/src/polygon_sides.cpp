#include "polygon_sides.h"

#include <algorithm>
#include <cmath>

#include "planar_cross.h"

namespace supple::voronoi {

using Eigen::Vector2d;

Side reversed(const Side& side) {
  Side result{side.to, side.from, side.cuts, side.shares, side.sites};
  std::reverse(result.cuts.begin(), result.cuts.end());
  std::reverse(result.shares.begin(), result.shares.end());
  std::reverse(result.sites.begin(), result.sites.end());
  for (double& share : result.shares) share = 1 - share;
  return result;
}

std::pair<Side, Side> split(const Side& side, double at) {
  const Vector2d middle = side.from + at * (side.to - side.from);
  Side first{side.from, middle, {}, {}, {}};
  Side second{middle, side.to, {}, {}, {}};
  const auto before =
      static_cast<std::size_t>(std::upper_bound(side.shares.begin(), side.shares.end(), at) - side.shares.begin());
  for (std::size_t i = 0; i < side.shares.size(); ++i) {
    Side& part = i < before ? first : second;
    part.cuts.push_back(side.cuts[i]);
    part.shares.push_back(i < before ? side.shares[i] / at : (side.shares[i] - at) / (1 - at));
  }
  first.sites.assign(side.sites.begin(), side.sites.begin() + static_cast<std::ptrdiff_t>(before) + 1);
  second.sites.assign(side.sites.begin() + static_cast<std::ptrdiff_t>(before), side.sites.end());
  return {first, second};
}

bool choose_chord(const Sides& sides, BorderPlace& begin, BorderPlace& end) {
  struct Arc {
    std::int32_t site;
    BorderPlace middle;  ///< of its longest straight part
    double length = -1;
  };
  std::vector<Arc> arcs;
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Side& side = sides[k];
    const double length = (side.to - side.from).norm();
    double before = 0;
    for (std::size_t i = 0; i < side.sites.size(); ++i) {
      const double after = i < side.shares.size() ? side.shares[i] : 1;
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
  std::size_t smaller = 0;  // of the numbers of arcs on either side
  double best = 0;
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    for (std::size_t j = i + 2; j < arcs.size() && j - i + 1 < arcs.size(); ++j) {
      if (arcs[i].middle.side == arcs[j].middle.side) continue;
      const bool same = arcs[i].site == arcs[j].site;
      const std::size_t fewer = std::min(j - i, arcs.size() - (j - i));
      const double length = std::min(arcs[i].length, arcs[j].length);
      if (!(length > 0) || (of_one_site && !same)) continue;
      // Lines within a cell first, those that leave as much on either side before others.
      if (same == of_one_site && (same ? std::pair(fewer, length) <= std::pair(smaller, best) : length <= best))
        continue;
      of_one_site = same;
      smaller = fewer;
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

void choose_middle(const Sides& sides, double longest, BorderPlace& begin, BorderPlace& end) {
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
