#include "chains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "reading.h"

namespace supple::outlines {
namespace {

/// The two ends of open polylines, found by their place.
class Ends {
 public:
  struct End {
    std::size_t polyline;
    bool last;  ///< of its points, or the first
  };

  explicit Ends(double reach) : reach_(reach) {}

  void add(const Polyline& polyline, std::size_t index) {
    for (const bool last : {false, true}) {
      const Point& p = last ? polyline.points.back() : polyline.points.front();
      ends_[key(polyline.group, cell(p.x()), cell(p.y()))].push_back({{index, last}, p});
    }
  }
  void remove(const Polyline& polyline, std::size_t index) {
    for (const Point& p : {polyline.points.front(), polyline.points.back()}) {
      const auto found = ends_.find(key(polyline.group, cell(p.x()), cell(p.y())));
      if (found == ends_.end()) continue;
      std::erase_if(found->second, [index](const auto& entry) { return entry.first.polyline == index; });
    }
  }
  std::optional<End> nearest(const std::string& group, const Point& p) const {
    std::optional<End> best;
    double least = reach_;
    for (std::int64_t i = -1; i <= 1; ++i) {
      for (std::int64_t j = -1; j <= 1; ++j) {
        const auto found = ends_.find(key(group, cell(p.x()) + i, cell(p.y()) + j));
        if (found == ends_.end()) continue;
        for (const auto& [end, place] : found->second) {
          const double distance = (place - p).norm();
          const bool first_of_equals = best && distance == least && end.polyline < best->polyline;
          if (distance > least || (best && distance == least && !first_of_equals)) continue;
          least = distance;
          best = end;
        }
      }
    }
    return best;
  }

 private:
  using Key = std::pair<std::string, std::array<std::int64_t, 2>>;

  std::int64_t cell(double coordinate) const { return static_cast<std::int64_t>(std::floor(coordinate / reach_)); }
  static Key key(const std::string& group, std::int64_t x, std::int64_t y) { return {group, {x, y}}; }

  double reach_;
  std::map<Key, std::vector<std::pair<End, Point>>> ends_;
};

bool ends_meet(const Polyline& polyline, double reach) {
  return polyline.points.size() > 2 && (polyline.points.front() - polyline.points.back()).norm() <= reach;
}

}  // namespace

std::vector<Polyline> joined(std::vector<Polyline> polylines, double reach, const Execution& execution) {
  Ends ends(reach);
  std::vector<bool> used(polylines.size(), false);
  for (std::size_t i = 0; i < polylines.size(); ++i) {
    Polyline& polyline = polylines[i];
    if (!polyline.closed && ends_meet(polyline, reach)) polyline.closed = true;
    if (!polyline.closed) ends.add(polyline, i);
  }
  std::vector<Polyline> result;
  for (std::size_t i = 0; i < polylines.size(); ++i) {
    if (i % curves_between_checks == 0) execution.cancellation.throw_if_requested();
    if (used[i]) continue;
    Polyline chain = std::move(polylines[i]);
    if (!chain.closed) ends.remove(chain, i);
    // Forwards from the last point until nothing follows, then backwards from the first.
    for (int turn = 0; turn < 2 && !chain.closed; ++turn) {
      while (!chain.closed) {
        const auto next = ends.nearest(chain.group, chain.points.back());
        if (!next) break;
        Polyline& other = polylines[next->polyline];
        ends.remove(other, next->polyline);
        used[next->polyline] = true;
        if (next->last) std::reverse(other.points.begin(), other.points.end());
        chain.points.insert(chain.points.end(), other.points.begin() + 1, other.points.end());
        chain.curves += other.curves;
        chain.closed = ends_meet(chain, reach);
      }
      if (!chain.closed) std::reverse(chain.points.begin(), chain.points.end());
    }
    result.push_back(std::move(chain));
  }
  return result;
}

}  // namespace supple::outlines
