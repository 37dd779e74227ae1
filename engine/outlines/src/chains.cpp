#include "chains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "grid_cells.h"
#include "polygon_measures.h"
#include "reading.h"

namespace supple::outlines {
namespace {

/// Fractions of the reach within which ends are joined, one after another.
constexpr std::array<double, 5> reaches{1e-4, 1e-3, 1e-2, 1e-1, 1};
/// Lines up to so many reaches are merged with their neighbours as soon as these meet them.
constexpr double longest_merged = 2;
/// Two short lines lie over each other only if their ends are nearer than this fraction of their length.
constexpr double same_end = 0.25;

/// Sides of the cells in which ends are looked for, in reaches: mostly one cell is near an end.
constexpr double cell_size = 16;

using Cells = std::unordered_map<GridCell, std::vector<std::size_t>, GridCell::Hash>;

double length_of(const Points& points) {
  double length = 0;
  for (std::size_t k = 1; k < points.size(); ++k) length += (points[k] - points[k - 1]).norm();
  return length;
}

/// An open chain of polylines.
struct Chain {
  Points points;
  std::vector<std::size_t> members;  ///< polylines in the order of the chain
  double length = 0;
  std::size_t group = 0;  ///< a number for each group

  std::size_t first_member() const { return *std::min_element(members.begin(), members.end()); }
};

class Sets {
 public:
  explicit Sets(std::size_t size) : parents_(size) { std::iota(parents_.begin(), parents_.end(), 0U); }
  std::size_t find(std::size_t k) {
    while (parents_[k] != k) k = parents_[k] = parents_[parents_[k]];
    return k;
  }
  void unite(std::size_t a, std::size_t b) { parents_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parents_;
};

/// Joins the chains of one reach: their ends are nodes, and the chains are edges between them.
class Graph {
 public:
  /// Lines up to the length `merged_below` are merged with what follows them, since they would close by themselves at a
  /// greater reach; longer ones wait for it, as something else may meet them there.
  Graph(std::vector<Chain>& chains, double reach, double merged_below, bool by_group, const Execution& execution)
      : chains_(chains),
        reach_(reach),
        merged_below_(merged_below),
        execution_(execution),
        ends_(2 * chains.size()),
        used_(chains.size(), false) {
    find_nodes(by_group);
  }

  /// Closed chains go to `closed`; open ones are merged where exactly two of them meet.
  void join(std::vector<Chain>& closed, std::vector<Point>& branches) {
    close_loops(closed);
    find_core();
    close_core(closed, branches);
    merge_rest();
    std::vector<Chain> left;
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (!used_[k]) left.push_back(std::move(chains_[k]));
    }
    for (Chain& chain : merged_) left.push_back(std::move(chain));
    chains_ = std::move(left);
  }

 private:
  // Half-edge 2 k runs along chain k, and 2 k + 1 against it.
  std::size_t from(std::size_t half) const { return ends_[half]; }
  std::size_t to(std::size_t half) const { return ends_[half ^ 1U]; }

  const Point& end_point(std::size_t half) const {
    const Points& points = chains_[half / 2].points;
    return half % 2 == 0 ? points.front() : points.back();
  }

  void find_nodes(bool by_group) {
    Cells cells;
    Sets sets(ends_.size());
    for (std::size_t half = 0; half < ends_.size(); ++half) {
      if (half % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      const Chain& chain = chains_[half / 2];
      if (chain.length <= reach_) continue;  // it would close by itself
      const std::size_t group = by_group ? chain.group : 0;
      const Point& end = end_point(half);
      const double size = cell_size * reach_;
      any_cell_near(
          end, reach_, size,
          [&](const GridCell& cell) {
            const auto found = cells.find(cell);
            if (found == cells.end()) return false;
            for (const std::size_t other : found->second) {
              if ((end_point(other) - end).norm() <= reach_) sets.unite(half, other);
            }
            return false;
          },
          group);
      // Ends in the same place are one node whichever of them represents it.
      auto& here = cells[cell_of(end, size, group)];
      const bool known =
          std::any_of(here.begin(), here.end(), [&](std::size_t other) { return end_point(other) == end; });
      if (!known) here.push_back(half);
    }
    for (std::size_t half = 0; half < ends_.size(); ++half) ends_[half] = sets.find(half);
  }

  void close_loops(std::vector<Chain>& closed) {
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (chains_[k].length <= reach_) {
        is_idle_.push_back(true);
        continue;
      }
      is_idle_.push_back(false);
      if (ends_[2 * k] != ends_[2 * k + 1]) continue;
      // Ends that only others between them connect are too far apart.
      if ((end_point(2 * k) - end_point(2 * k + 1)).norm() > reach_) {
        is_idle_[k] = true;
        continue;
      }
      used_[k] = true;
      closed.push_back(std::move(chains_[k]));
    }
  }

  bool is_active(std::size_t k) const { return !used_[k] && !is_idle_[k]; }

  /// Sorts the half-edges of active chains by the node where they begin.
  void list_at_nodes() {
    first_at_node_.assign(ends_.size() + 1, 0);
    for (std::size_t half = 0; half < ends_.size(); ++half) first_at_node_[ends_[half] + 1] += is_active(half / 2);
    std::partial_sum(first_at_node_.begin(), first_at_node_.end(), first_at_node_.begin());
    halves_.resize(first_at_node_.back());
    std::vector<std::size_t> next(first_at_node_.begin(), first_at_node_.end() - 1);
    for (std::size_t half = 0; half < ends_.size(); ++half) {
      if (is_active(half / 2)) halves_[next[ends_[half]]++] = half;
    }
  }

  /// The half-edges that begin at a node.
  std::span<const std::size_t> at_node(std::size_t node) const {
    return std::span(halves_).subspan(first_at_node_[node], first_at_node_[node + 1] - first_at_node_[node]);
  }

  /// The chains that are left when those with a free end are taken away again and again.
  void find_core() {
    list_at_nodes();
    std::vector<std::size_t> degree(ends_.size());
    std::vector<std::size_t> free;
    for (std::size_t node = 0; node < ends_.size(); ++node) {
      degree[node] = at_node(node).size();
      if (degree[node] == 1) free.push_back(node);
    }
    is_core_.assign(chains_.size(), false);
    for (std::size_t k = 0; k < chains_.size(); ++k) is_core_[k] = is_active(k);
    while (!free.empty()) {
      const std::size_t node = free.back();
      free.pop_back();
      for (const std::size_t half : at_node(node)) {
        if (!is_core_[half / 2]) continue;
        is_core_[half / 2] = false;
        --degree[node];
        if (--degree[to(half)] == 1) free.push_back(to(half));
      }
    }
  }

  std::vector<std::size_t> core_at(std::size_t node) const {
    std::vector<std::size_t> halves;
    for (const std::size_t half : at_node(node)) {
      if (is_core_[half / 2]) halves.push_back(half);
    }
    return halves;
  }

  /// The direction in which a half-edge leaves its node.
  double angle_of(std::size_t half) const {
    const Points& points = chains_[half / 2].points;
    const std::size_t n = points.size();
    const Point& start = end_point(half);
    for (std::size_t k = 1; k < n; ++k) {
      const Point& p = half % 2 == 0 ? points[k] : points[n - 1 - k];
      if ((p - start).norm() > reach_ || k + 1 == n) return std::atan2(p.y() - start.y(), p.x() - start.x());
    }
    return 0;
  }

  void append(Chain& chain, std::size_t half) const {
    const Chain& other = chains_[half / 2];
    const std::size_t skip = chain.points.empty() ? 0 : 1;
    if (half % 2 == 0) {
      chain.points.insert(chain.points.end(), other.points.begin() + static_cast<std::ptrdiff_t>(skip),
                          other.points.end());
      chain.members.insert(chain.members.end(), other.members.begin(), other.members.end());
    } else {
      chain.points.insert(chain.points.end(), other.points.rbegin() + static_cast<std::ptrdiff_t>(skip),
                          other.points.rend());
      chain.members.insert(chain.members.end(), other.members.rbegin(), other.members.rend());
    }
    chain.length += other.length;
  }

  void close_core(std::vector<Chain>& closed, std::vector<Point>& branches) {
    std::vector<std::size_t> next(ends_.size());  // of half-edges, along the area to their left
    std::vector<std::pair<double, std::size_t>> around;
    for (std::size_t node = 0; node < ends_.size(); ++node) {
      const auto halves = core_at(node);
      if (halves.size() == 2) {
        next[halves[0] ^ 1U] = halves[1];
        next[halves[1] ^ 1U] = halves[0];
        continue;
      }
      around.clear();
      for (const std::size_t half : halves) around.emplace_back(angle_of(half), half);
      std::sort(around.begin(), around.end());
      // What comes in along the reverse of a half-edge leaves by the one before it counterclockwise.
      for (std::size_t k = 0; k < around.size(); ++k)
        next[around[k].second ^ 1U] = around[(k + around.size() - 1) % around.size()].second;
      if (halves.size() > 2) branches.push_back(end_point(halves.front()));
    }
    std::vector<bool> walked(2 * chains_.size(), false);
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (k % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      if (!is_core_[k]) continue;
      for (const std::size_t start : {2 * k, 2 * k + 1}) {
        if (walked[start]) continue;
        Chain chain;
        chain.group = chains_[k].group;
        bool is_simple_cycle = true;
        std::size_t half = start;
        do {
          walked[half] = true;
          append(chain, half);
          is_simple_cycle = is_simple_cycle && at_core_degree(to(half)) == 2;
          half = next[half];
        } while (half != start);
        if (is_simple_cycle) {
          // Both directions are the same curve; it keeps that of its first piece.
          std::size_t back = start;
          do {
            walked[back ^ 1U] = true;
            back = next[back];
          } while (back != start);
        } else if (area_of(chain.points) <= 0) {
          continue;  // the outside
        }
        closed.push_back(std::move(chain));
      }
    }
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (is_core_[k]) used_[k] = true;
    }
  }

  std::size_t at_core_degree(std::size_t node) const {
    std::size_t count = 0;
    for (const std::size_t half : at_node(node)) count += is_core_[half / 2] ? 1 : 0;
    return count;
  }

  std::vector<std::size_t> open_at(std::size_t node) const {
    std::vector<std::size_t> halves;
    for (const std::size_t half : at_node(node)) {
      if (!used_[half / 2]) halves.push_back(half);
    }
    return halves;
  }

  /// Merges open chains in a row, of which each end meets one other and nothing that closed.
  void merge_rest() {
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (!is_active(k)) continue;
      // Back to where the row begins, which it does since nothing closes.
      std::size_t half = 2 * k;
      for (auto before = before_in_row(half); before; before = before_in_row(half)) half = *before;
      Chain chain;
      chain.group = chains_[half / 2].group;
      std::vector<std::size_t> row;
      for (std::optional<std::size_t> at = half; at; at = after_in_row(*at)) row.push_back(*at);
      if (row.size() == 1) continue;
      for (const std::size_t one : row) append(chain, one);
      for (const std::size_t one : row) used_[one / 2] = true;
      merged_.push_back(std::move(chain));
    }
  }

  std::optional<std::size_t> after_in_row(std::size_t half) const {
    const auto halves = open_at(to(half));
    if (halves.size() != 2) return std::nullopt;
    const std::size_t other = halves[0] / 2 == half / 2 ? halves[1] : halves[0];
    if (other / 2 == half / 2) return std::nullopt;
    if (std::min(chains_[half / 2].length, chains_[other / 2].length) > merged_below_) return std::nullopt;
    return other;
  }
  std::optional<std::size_t> before_in_row(std::size_t half) const {
    const auto after = after_in_row(half ^ 1U);
    if (!after) return std::nullopt;
    return *after ^ 1U;
  }

  std::vector<Chain>& chains_;
  double reach_, merged_below_;
  const Execution& execution_;
  std::vector<std::size_t> ends_;  ///< of half-edges: the node where each begins
  std::vector<bool> used_, is_idle_, is_core_;
  std::vector<std::size_t> halves_;         ///< half-edges by the node where they begin
  std::vector<std::size_t> first_at_node_;  ///< where those of a node begin in `halves_`
  std::vector<Chain> merged_;
};

/// Takes away open chains that lie over others.
void drop_doubled(std::vector<Chain>& chains, double reach, bool by_group, std::vector<std::size_t>& doubled,
                  const Execution& execution) {
  Cells cells;
  std::vector<Chain> kept;
  kept.reserve(chains.size());
  for (std::size_t k = 0; k < chains.size(); ++k) {
    if (k % curves_between_checks == 0) execution.cancellation.throw_if_requested();
    Chain& chain = chains[k];
    const double close = std::min(reach, same_end * chain.length);
    const Point middle = (chain.points.front() + chain.points.back()) / 2;
    const std::size_t group = by_group ? chain.group : 0;
    const double size = cell_size * reach;
    const bool found = any_cell_near(
        middle, reach, size,
        [&](const GridCell& cell) {
          const auto near = cells.find(cell);
          return near != cells.end() && std::any_of(near->second.begin(), near->second.end(), [&](std::size_t other) {
                   return is_same_curve(kept[other].points, chain.points, close, false);
                 });
        },
        group);
    if (found) {
      doubled.insert(doubled.end(), chain.members.begin(), chain.members.end());
      continue;
    }
    cells[cell_of(middle, size, group)].push_back(kept.size());
    kept.push_back(std::move(chain));
  }
  chains = std::move(kept);
}

}  // namespace

Chains joined(std::vector<Polyline>& polylines, double reach, const Execution& execution) {
  Chains result;
  std::vector<Chain> open, closed;
  std::vector<std::pair<std::size_t, std::size_t>> order;  // by the first polyline; open ones after closed ones
  constexpr std::size_t alone = SIZE_MAX;                  // for a polyline that is closed as it stands
  std::map<std::string_view, std::size_t> groups;
  for (std::size_t i = 0; i < polylines.size(); ++i) {
    const Polyline& polyline = polylines[i];
    const bool back_again = polyline.points.size() > 2 && polyline.points.front() == polyline.points.back();
    if (polyline.closed || back_again) {
      order.emplace_back(i, alone);
      continue;
    }
    const std::size_t group = groups.try_emplace(polyline.source->group, groups.size()).first->second;
    open.push_back({polyline.points, {i}, length_of(polyline.points), group});
  }
  drop_doubled(open, reach, true, result.doubled, execution);
  std::size_t closed_by_group = 0;
  for (const bool by_group : {true, false}) {
    if (!by_group) drop_doubled(open, reach, false, result.doubled, execution);
    for (const double fraction : reaches) {
      if (!open.empty())
        Graph(open, fraction * reach, longest_merged * reach, by_group, execution).join(closed, result.branches);
    }
    if (by_group) closed_by_group = closed.size();
  }
  for (std::size_t k = 0; k < closed.size() + open.size(); ++k)
    order.emplace_back((k < closed.size() ? closed[k] : open[k - closed.size()]).first_member(), k);
  std::sort(order.begin(), order.end());
  result.polylines.reserve(order.size());
  result.members.reserve(order.size());
  for (const auto& [first, k] : order) {
    if (k == alone) {
      polylines[first].closed = true;
      result.polylines.push_back(std::move(polylines[first]));
      result.members.push_back({first});
      continue;
    }
    Chain& chain = k < closed.size() ? closed[k] : open[k - closed.size()];
    Polyline polyline{std::move(chain.points), k < closed.size(), polylines[first].source, chain.members.size()};
    for (const std::size_t member : chain.members) polyline.error = std::max(polyline.error, polylines[member].error);
    if (polyline.closed && k >= closed_by_group && polyline.curves > 1)
      result.across.push_back(result.polylines.size());
    result.polylines.push_back(std::move(polyline));
    result.members.push_back(std::move(chain.members));
  }
  return result;
}

}  // namespace supple::outlines
