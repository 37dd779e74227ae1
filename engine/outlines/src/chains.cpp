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

/// Fractions of the maximum gap at which ends are joined, in this order.
constexpr std::array<double, 5> gap_fractions{1e-4, 1e-3, 1e-2, 1e-1, 1};
/// Open lines up to this length, in units of the maximum gap, are merged with a neighbour as soon as it meets them.
constexpr double max_merged_gaps = 2;
/// Ratio of distance to length above which lines do not lie over each other; it matters for lines below four gaps.
constexpr double max_distance_ratio = 0.25;

/// Side of the grid cells in which ends are searched, in units of the gap: so large that mostly one cell is visited.
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

/// Union-find over the numbers below `size`.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parents_(size) { std::iota(parents_.begin(), parents_.end(), 0U); }
  std::size_t find(std::size_t k) {
    while (parents_[k] != k) k = parents_[k] = parents_[parents_[k]];
    return k;
  }
  void unite(std::size_t a, std::size_t b) { parents_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parents_;
};

/// Joins chains at one gap. The edges of the graph are the chains; a node is a cluster of ends within the gap.
class Graph {
 public:
  /// Open chains up to `max_merged_length` are merged with their neighbours now, since they would close by themselves
  /// at a larger gap. Longer ones are left for larger gaps, at which other chains may meet them.
  Graph(std::vector<Chain>& chains, double gap, double max_merged_length, bool by_group, const Execution& execution)
      : chains_(chains),
        gap_(gap),
        max_merged_length_(max_merged_length),
        execution_(execution),
        start_nodes_(2 * chains.size()),
        used_(chains.size(), false) {
    find_nodes(by_group);
  }

  /// Moves closed chains to `closed`, adds the points where they branch to `branches`, and merges open chains where
  /// exactly two of them meet.
  void join(std::vector<Chain>& closed, std::vector<Point>& branches) {
    close_loops(closed);
    find_core();
    close_core(closed, branches);
    merge_rest();
    std::vector<Chain> remaining;
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (!used_[k]) remaining.push_back(std::move(chains_[k]));
    }
    for (Chain& chain : merged_) remaining.push_back(std::move(chain));
    chains_ = std::move(remaining);
  }

 private:
  // Half-edge 2 k runs along chain k, and 2 k + 1 against it.
  std::size_t from(std::size_t half_edge) const { return start_nodes_[half_edge]; }
  std::size_t to(std::size_t half_edge) const { return start_nodes_[half_edge ^ 1U]; }

  const Point& end_point(std::size_t half_edge) const {
    const Points& points = chains_[half_edge / 2].points;
    return half_edge % 2 == 0 ? points.front() : points.back();
  }

  void find_nodes(bool by_group) {
    Cells cells;
    DisjointSets sets(start_nodes_.size());
    for (std::size_t half_edge = 0; half_edge < start_nodes_.size(); ++half_edge) {
      if (half_edge % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      const Chain& chain = chains_[half_edge / 2];
      if (chain.length <= gap_) continue;  // it would close on itself
      const std::size_t group = by_group ? chain.group : 0;
      const Point& end = end_point(half_edge);
      const double size = cell_size * gap_;
      any_cell_near(
          end, gap_, size,
          [&](const GridCell& cell) {
            const auto found = cells.find(cell);
            if (found == cells.end()) return false;
            for (const std::size_t other : found->second) {
              if ((end_point(other) - end).norm() <= gap_) sets.unite(half_edge, other);
            }
            return false;
          },
          group);
      // One of several ends in the same point is enough to find their node.
      auto& here = cells[cell_of(end, size, group)];
      const bool known =
          std::any_of(here.begin(), here.end(), [&](std::size_t other) { return end_point(other) == end; });
      if (!known) here.push_back(half_edge);
    }
    for (std::size_t half_edge = 0; half_edge < start_nodes_.size(); ++half_edge)
      start_nodes_[half_edge] = sets.find(half_edge);
  }

  void close_loops(std::vector<Chain>& closed) {
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (chains_[k].length <= gap_) {
        is_idle_.push_back(true);
        continue;
      }
      is_idle_.push_back(false);
      if (start_nodes_[2 * k] != start_nodes_[2 * k + 1]) continue;
      // Its ends belong to one node only through other ends between them, and are too far apart.
      if ((end_point(2 * k) - end_point(2 * k + 1)).norm() > gap_) {
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
    first_at_node_.assign(start_nodes_.size() + 1, 0);
    for (std::size_t half_edge = 0; half_edge < start_nodes_.size(); ++half_edge)
      first_at_node_[start_nodes_[half_edge] + 1] += is_active(half_edge / 2);
    std::partial_sum(first_at_node_.begin(), first_at_node_.end(), first_at_node_.begin());
    half_edges_.resize(first_at_node_.back());
    std::vector<std::size_t> next(first_at_node_.begin(), first_at_node_.end() - 1);
    for (std::size_t half_edge = 0; half_edge < start_nodes_.size(); ++half_edge) {
      if (is_active(half_edge / 2)) half_edges_[next[start_nodes_[half_edge]]++] = half_edge;
    }
  }

  /// The half-edges that begin at a node.
  std::span<const std::size_t> at_node(std::size_t node) const {
    return std::span(half_edges_).subspan(first_at_node_[node], first_at_node_[node + 1] - first_at_node_[node]);
  }

  /// Finds the 2-core of the graph: the chains that remain when those with a free end are removed repeatedly.
  void find_core() {
    list_at_nodes();
    std::vector<std::size_t> degree(start_nodes_.size());
    std::vector<std::size_t> free;
    for (std::size_t node = 0; node < start_nodes_.size(); ++node) {
      degree[node] = at_node(node).size();
      if (degree[node] == 1) free.push_back(node);
    }
    is_core_.assign(chains_.size(), false);
    for (std::size_t k = 0; k < chains_.size(); ++k) is_core_[k] = is_active(k);
    while (!free.empty()) {
      const std::size_t node = free.back();
      free.pop_back();
      for (const std::size_t half_edge : at_node(node)) {
        if (!is_core_[half_edge / 2]) continue;
        is_core_[half_edge / 2] = false;
        --degree[node];
        if (--degree[to(half_edge)] == 1) free.push_back(to(half_edge));
      }
    }
  }

  std::vector<std::size_t> core_at(std::size_t node) const {
    std::vector<std::size_t> half_edges;
    for (const std::size_t half_edge : at_node(node)) {
      if (is_core_[half_edge / 2]) half_edges.push_back(half_edge);
    }
    return half_edges;
  }

  /// The direction in which a half-edge leaves its node, radians.
  double angle_of(std::size_t half_edge) const {
    const Points& points = chains_[half_edge / 2].points;
    const std::size_t n = points.size();
    const Point& start = end_point(half_edge);
    for (std::size_t k = 1; k < n; ++k) {
      const Point& p = half_edge % 2 == 0 ? points[k] : points[n - 1 - k];
      if ((p - start).norm() > gap_ || k + 1 == n) return std::atan2(p.y() - start.y(), p.x() - start.x());
    }
    return 0;
  }

  void append(Chain& chain, std::size_t half_edge) const {
    const Chain& other = chains_[half_edge / 2];
    const std::size_t skip = chain.points.empty() ? 0 : 1;
    if (half_edge % 2 == 0) {
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
    std::vector<std::size_t> next(start_nodes_.size());  // for each half-edge, the next one along the area to its left
    std::vector<std::pair<double, std::size_t>> by_angle;
    for (std::size_t node = 0; node < start_nodes_.size(); ++node) {
      const auto half_edges = core_at(node);
      if (half_edges.size() == 2) {
        next[half_edges[0] ^ 1U] = half_edges[1];
        next[half_edges[1] ^ 1U] = half_edges[0];
        continue;
      }
      by_angle.clear();
      for (const std::size_t half_edge : half_edges) by_angle.emplace_back(angle_of(half_edge), half_edge);
      std::sort(by_angle.begin(), by_angle.end());
      // The boundary that arrives along the reverse of a half-edge leaves by the half-edge before it counterclockwise.
      for (std::size_t k = 0; k < by_angle.size(); ++k)
        next[by_angle[k].second ^ 1U] = by_angle[(k + by_angle.size() - 1) % by_angle.size()].second;
      if (half_edges.size() > 2) branches.push_back(end_point(half_edges.front()));
    }
    std::vector<bool> visited(2 * chains_.size(), false);
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (k % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      if (!is_core_[k]) continue;
      for (const std::size_t start : {2 * k, 2 * k + 1}) {
        if (visited[start]) continue;
        Chain chain;
        chain.group = chains_[k].group;
        bool is_simple_cycle = true;
        std::size_t half_edge = start;
        do {
          visited[half_edge] = true;
          append(chain, half_edge);
          is_simple_cycle = is_simple_cycle && core_degree(to(half_edge)) == 2;
          half_edge = next[half_edge];
        } while (half_edge != start);
        if (is_simple_cycle) {
          // Both directions are the same curve; the direction of its first piece is chosen.
          std::size_t back = start;
          do {
            visited[back ^ 1U] = true;
            back = next[back];
          } while (back != start);
        } else if (area_of(chain.points) <= 0) {
          continue;  // the unbounded area
        }
        closed.push_back(std::move(chain));
      }
    }
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (is_core_[k]) used_[k] = true;
    }
  }

  std::size_t core_degree(std::size_t node) const {
    std::size_t count = 0;
    for (const std::size_t half_edge : at_node(node)) count += is_core_[half_edge / 2] ? 1 : 0;
    return count;
  }

  std::vector<std::size_t> open_at(std::size_t node) const {
    std::vector<std::size_t> half_edges;
    for (const std::size_t half_edge : at_node(node)) {
      if (!used_[half_edge / 2]) half_edges.push_back(half_edge);
    }
    return half_edges;
  }

  /// Merges sequences of open chains: those in which exactly two open chains meet at each joint.
  void merge_rest() {
    for (std::size_t k = 0; k < chains_.size(); ++k) {
      if (!is_active(k)) continue;
      // Go back to the first chain of the sequence. There is one, because cycles are closed already.
      std::size_t half_edge = 2 * k;
      for (auto before = predecessor(half_edge); before; before = predecessor(half_edge)) half_edge = *before;
      Chain chain;
      chain.group = chains_[half_edge / 2].group;
      std::vector<std::size_t> sequence;
      for (std::optional<std::size_t> at = half_edge; at; at = successor(*at)) sequence.push_back(*at);
      if (sequence.size() == 1) continue;
      for (const std::size_t one : sequence) append(chain, one);
      for (const std::size_t one : sequence) used_[one / 2] = true;
      merged_.push_back(std::move(chain));
    }
  }

  std::optional<std::size_t> successor(std::size_t half_edge) const {
    const auto half_edges = open_at(to(half_edge));
    if (half_edges.size() != 2) return std::nullopt;
    const std::size_t other = half_edges[0] / 2 == half_edge / 2 ? half_edges[1] : half_edges[0];
    if (other / 2 == half_edge / 2) return std::nullopt;
    if (std::min(chains_[half_edge / 2].length, chains_[other / 2].length) > max_merged_length_) return std::nullopt;
    return other;
  }
  std::optional<std::size_t> predecessor(std::size_t half_edge) const {
    const auto after = successor(half_edge ^ 1U);
    if (!after) return std::nullopt;
    return *after ^ 1U;
  }

  std::vector<Chain>& chains_;
  double gap_, max_merged_length_;
  const Execution& execution_;
  std::vector<std::size_t> start_nodes_;        ///< for each half-edge, the node where it begins
  std::vector<bool> used_, is_idle_, is_core_;  ///< for each chain: joined; not to be joined at this gap; in the 2-core
  std::vector<std::size_t> half_edges_;         ///< sorted by the node where they begin
  std::vector<std::size_t> first_at_node_;      ///< for each node, where its half-edges begin in `half_edges_`
  std::vector<Chain> merged_;
};

/// Drops open chains that lie over others, and adds the polylines in them to `duplicates`.
void drop_duplicates(std::vector<Chain>& chains, double max_gap, bool by_group, std::vector<std::size_t>& duplicates,
                     const Execution& execution) {
  Cells cells;
  std::vector<Chain> remaining;
  remaining.reserve(chains.size());
  for (std::size_t k = 0; k < chains.size(); ++k) {
    if (k % curves_between_checks == 0) execution.cancellation.throw_if_requested();
    Chain& chain = chains[k];
    const double max_distance = std::min(max_gap, max_distance_ratio * chain.length);
    const Point middle = (chain.points.front() + chain.points.back()) / 2;
    const std::size_t group = by_group ? chain.group : 0;
    const double size = cell_size * max_gap;
    const bool found = any_cell_near(
        middle, max_gap, size,
        [&](const GridCell& cell) {
          const auto near = cells.find(cell);
          return near != cells.end() && std::any_of(near->second.begin(), near->second.end(), [&](std::size_t other) {
                   return is_same_curve(remaining[other].points, chain.points, max_distance, false);
                 });
        },
        group);
    if (found) {
      duplicates.insert(duplicates.end(), chain.members.begin(), chain.members.end());
      continue;
    }
    cells[cell_of(middle, size, group)].push_back(remaining.size());
    remaining.push_back(std::move(chain));
  }
  chains = std::move(remaining);
}

}  // namespace

Chains joined(std::vector<Polyline>& polylines, double max_gap, const Execution& execution) {
  Chains result;
  std::vector<Chain> open, closed;
  std::vector<std::pair<std::size_t, std::size_t>> order;  // first polyline; index in `closed`, then `open`
  constexpr std::size_t no_joining = SIZE_MAX;             // the index of a polyline that needs no joining
  std::map<std::string_view, std::size_t> groups;
  for (std::size_t i = 0; i < polylines.size(); ++i) {
    const Polyline& polyline = polylines[i];
    const bool returns_to_start = polyline.points.size() > 2 && polyline.points.front() == polyline.points.back();
    if (polyline.closed || returns_to_start) {
      order.emplace_back(i, no_joining);
      continue;
    }
    const std::size_t group = groups.try_emplace(polyline.source->group, groups.size()).first->second;
    open.push_back({polyline.points, {i}, length_of(polyline.points), group});
  }
  drop_duplicates(open, max_gap, true, result.duplicates, execution);
  std::size_t closed_by_group = 0;
  for (const bool by_group : {true, false}) {
    if (!by_group) drop_duplicates(open, max_gap, false, result.duplicates, execution);
    for (const double fraction : gap_fractions) {
      if (!open.empty())
        Graph(open, fraction * max_gap, max_merged_gaps * max_gap, by_group, execution).join(closed, result.branches);
    }
    if (by_group) closed_by_group = closed.size();
  }
  for (std::size_t k = 0; k < closed.size() + open.size(); ++k)
    order.emplace_back((k < closed.size() ? closed[k] : open[k - closed.size()]).first_member(), k);
  std::sort(order.begin(), order.end());
  result.polylines.reserve(order.size());
  result.members.reserve(order.size());
  for (const auto& [first, k] : order) {
    if (k == no_joining) {
      polylines[first].closed = true;
      result.polylines.push_back(std::move(polylines[first]));
      result.members.push_back({first});
      continue;
    }
    Chain& chain = k < closed.size() ? closed[k] : open[k - closed.size()];
    Polyline polyline{std::move(chain.points), k < closed.size(), polylines[first].source, chain.members.size()};
    for (const std::size_t member : chain.members) polyline.error = std::max(polyline.error, polylines[member].error);
    if (polyline.closed && k >= closed_by_group && polyline.curves > 1)
      result.across_groups.push_back(result.polylines.size());
    result.polylines.push_back(std::move(polyline));
    result.members.push_back(std::move(chain.members));
  }
  return result;
}

}  // namespace supple::outlines
