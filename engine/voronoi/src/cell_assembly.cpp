#include "cell_assembly.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace supple::voronoi {
namespace {

using Kind = DiagramPoint::Kind;

class Assembly {
 public:
  Assembly(const std::vector<BorderPart>& parts, double merged, Diagram& diagram)
      : parts_(parts), merged_(merged), diagram_(diagram) {
    for (const DiagramPoint& point : diagram.points) has_arms_.push_back(point.kind == Kind::vertex ? 1 : 0);
  }

  void run() {
    sort_by_points();
    trace_edges();
    merge_vertices();
    make_vertices();
    trace_cells();
    make_dual();
  }

 private:
  /// A part of a border, walked forwards (2 i) or backwards (2 i + 1).
  using Way = std::int32_t;
  const BorderPart& part(Way way) const { return parts_[static_cast<std::size_t>(way / 2)]; }
  std::int32_t begin_of(Way way) const { return way % 2 == 0 ? part(way).from : part(way).to; }
  std::int32_t end_of(Way way) const { return way % 2 == 0 ? part(way).to : part(way).from; }
  std::int32_t left_of(Way way) const { return way % 2 == 0 ? part(way).left : part(way).right; }
  std::int32_t right_of(Way way) const { return way % 2 == 0 ? part(way).right : part(way).left; }
  bool is_border(Way way) const { return part(way).right >= 0; }
  bool is_vertex(std::int32_t point) const { return has_arms_[static_cast<std::size_t>(point)] != 0; }
  const Eigen::Vector3d& place(std::int32_t point) const {
    return diagram_.points[static_cast<std::size_t>(point)].position;
  }

  /// The ways that leave each point, in the order of the parts.
  void sort_by_points() {
    first_.assign(diagram_.points.size() + 1, 0);
    const auto count = static_cast<Way>(2 * parts_.size());
    for (Way way = 0; way < count; ++way) ++first_[static_cast<std::size_t>(begin_of(way)) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    leaving_.resize(static_cast<std::size_t>(count));
    std::vector<std::int32_t> place(first_.begin(), first_.end() - 1);
    for (Way way = 0; way < count; ++way)
      leaving_[static_cast<std::size_t>(place[static_cast<std::size_t>(begin_of(way))]++)] = way;
  }

  /// Ways from a point.
  std::pair<std::int32_t, std::int32_t> leaving(std::int32_t point) const {
    return {first_[static_cast<std::size_t>(point)], first_[static_cast<std::size_t>(point) + 1]};
  }

  static Way back(Way way) { return way ^ 1; }

  /// How a border goes on from the end of a way; -1 at a vertex, at the mesh's boundary.
  Way border_after(Way way) const {
    const std::int32_t point = end_of(way);
    if (is_vertex(point)) return -1;
    const auto [begin, end] = leaving(point);
    for (std::int32_t i = begin; i < end; ++i) {
      const Way next = leaving_[static_cast<std::size_t>(i)];
      if (next != back(way) && is_border(next)) return next;
    }
    return -1;
  }

  /// How the boundary of the cell on the left goes on.
  Way boundary_after(Way way) const {
    const std::int32_t point = end_of(way);
    const auto [begin, end] = leaving(point);
    if (is_vertex(point)) {
      Way only = -1;
      int ways = 0;
      for (std::int32_t i = begin; i < end; ++i) {
        const Way next = leaving_[static_cast<std::size_t>(i)];
        if (left_of(next) != left_of(way)) continue;
        only = next;
        ++ways;
      }
      if (ways == 1) return only;
      // A cell that meets the vertex more than once: the next clockwise, so that the cell lies between the two.
      for (std::int32_t i = begin; i < end; ++i)
        if (leaving_[static_cast<std::size_t>(i)] == back(way))
          return leaving_[static_cast<std::size_t>(i == begin ? end - 1 : i - 1)];
    }
    for (std::int32_t i = begin; i < end; ++i) {
      const Way next = leaving_[static_cast<std::size_t>(i)];
      if (next != back(way) && left_of(next) == left_of(way)) return next;
    }
    return -1;
  }

  void trace_edges() {
    std::vector<std::uint8_t> seen(parts_.size(), 0);
    const auto trace = [&](Way start) {
      DiagramEdge edge;
      edge.sites = {left_of(start), right_of(start)};
      edge.points.push_back(begin_of(start));
      for (Way way = start; way >= 0; way = border_after(way)) {
        if (seen[static_cast<std::size_t>(way / 2)] != 0) break;
        seen[static_cast<std::size_t>(way / 2)] = 1;
        edge.points.push_back(end_of(way));
        edge.length += part(way).length;
      }
      traced_.push_back(std::move(edge));
    };
    const auto count = static_cast<Way>(2 * parts_.size());
    const auto starts = [&](Way way) {
      if (!is_border(way)) return false;
      return is_vertex(begin_of(way)) || border_after(back(way)) < 0;
    };
    for (Way way = 0; way < count; ++way)
      if (seen[static_cast<std::size_t>(way / 2)] == 0 && starts(way)) trace(way);
    for (Way way = 0; way < count; way += 2)
      if (seen[static_cast<std::size_t>(way / 2)] == 0 && is_border(way)) trace(way);
  }

  std::int32_t root(std::int32_t point) {
    std::int32_t& up = root_[static_cast<std::size_t>(point)];
    return up == point ? point : up = root(up);
  }

  /// Of each vertex the one that stands for it.
  void merge_vertices() {
    root_.resize(diagram_.points.size());
    std::iota(root_.begin(), root_.end(), 0);
    for (const DiagramEdge& edge : traced_) {
      const std::int32_t a = edge.points.front();
      const std::int32_t b = edge.points.back();
      if (edge.length < merged_ && is_vertex(a) && is_vertex(b)) root_[static_cast<std::size_t>(root(a))] = root(b);
    }
  }

  /// Vertices with their sites in order, and the edges that are left.
  void make_vertices() {
    vertex_of_.assign(diagram_.points.size(), -1);
    for (std::size_t i = 0; i < diagram_.points.size(); ++i) {
      const auto point = static_cast<std::int32_t>(i);
      if (!is_vertex(point)) continue;
      std::int32_t& of_root = vertex_of_[static_cast<std::size_t>(root(point))];
      if (of_root < 0) {
        of_root = static_cast<std::int32_t>(diagram_.vertices.size());
        diagram_.vertices.push_back({root(point), {}});
      }
      vertex_of_[i] = of_root;
    }
    for (DiagramEdge& edge : traced_) {
      const std::int32_t a = vertex_of_[static_cast<std::size_t>(edge.points.front())];
      const std::int32_t b = vertex_of_[static_cast<std::size_t>(edge.points.back())];
      if (edge.length < merged_ && a == b) continue;  // a vertex that others stand for, or the tip of a tie
      edge.vertices = {a, b};
      diagram_.edges.push_back(std::move(edge));
    }
    dissolve_bends();
    order_sites();
    // A vertex all of whose edges have no length is none.
    std::vector<std::int32_t> renamed(diagram_.vertices.size(), -1);
    std::vector<DiagramVertex> kept;
    for (std::size_t i = 0; i < diagram_.vertices.size(); ++i) {
      if (diagram_.vertices[i].sites.empty()) continue;
      renamed[i] = static_cast<std::int32_t>(kept.size());
      kept.push_back(std::move(diagram_.vertices[i]));
    }
    diagram_.vertices = std::move(kept);
    for (std::int32_t& vertex : vertex_of_)
      if (vertex >= 0) vertex = renamed[static_cast<std::size_t>(vertex)];
    for (DiagramEdge& edge : diagram_.edges)
      for (std::int32_t& vertex : edge.vertices)
        if (vertex >= 0) vertex = renamed[static_cast<std::size_t>(vertex)];
  }

  /// Where borders run along edges of the mesh, ties leave vertices of two cells behind: bends of one edge.
  void dissolve_bends() {
    std::vector<std::vector<std::int32_t>> meeting(diagram_.vertices.size());
    for (std::size_t i = 0; i < diagram_.edges.size(); ++i)
      for (const std::int32_t vertex : diagram_.edges[i].vertices)
        if (vertex >= 0) meeting[static_cast<std::size_t>(vertex)].push_back(static_cast<std::int32_t>(i));
    for (std::size_t v = 0; v < meeting.size(); ++v) {
      if (meeting[v].size() != 2) continue;
      const auto vertex = static_cast<std::int32_t>(v);
      DiagramEdge& first = diagram_.edges[static_cast<std::size_t>(meeting[v][0])];
      if (meeting[v][0] == meeting[v][1]) {
        first.vertices = {-1, -1};
        continue;
      }
      DiagramEdge& second = diagram_.edges[static_cast<std::size_t>(meeting[v][1])];
      if (first.vertices[1] != vertex) turn(first);
      if (second.vertices[0] != vertex) turn(second);
      first.points.insert(first.points.end(), second.points.begin() + 1, second.points.end());
      first.length += second.length;
      first.vertices[1] = second.vertices[1];
      if (second.vertices[1] >= 0) {
        std::vector<std::int32_t>& there = meeting[static_cast<std::size_t>(second.vertices[1])];
        std::replace(there.begin(), there.end(), meeting[v][1], meeting[v][0]);
      }
      second.points.clear();
    }
    diagram_.edges.erase(std::remove_if(diagram_.edges.begin(), diagram_.edges.end(),
                                        [](const DiagramEdge& edge) { return edge.points.empty(); }),
                         diagram_.edges.end());
    for (std::size_t i = 0; i < vertex_of_.size(); ++i) {
      if (vertex_of_[i] < 0 || meeting[static_cast<std::size_t>(vertex_of_[i])].size() != 2) continue;
      vertex_of_[i] = -1;
      diagram_.points[i].kind = Kind::inner;
    }
  }

  static void turn(DiagramEdge& edge) {
    std::reverse(edge.points.begin(), edge.points.end());
    std::swap(edge.sites[0], edge.sites[1]);
    std::swap(edge.vertices[0], edge.vertices[1]);
  }

  void order_sites() {
    // Seen from a vertex along an edge that leaves it: the site on the left follows that on the right.
    struct Turn {
      std::int32_t vertex, right, left;
    };
    std::vector<Turn> turns;
    for (const DiagramEdge& edge : diagram_.edges) {
      if (edge.vertices[0] >= 0) turns.push_back({edge.vertices[0], edge.sites[1], edge.sites[0]});
      if (edge.vertices[1] >= 0) turns.push_back({edge.vertices[1], edge.sites[0], edge.sites[1]});
    }
    std::stable_sort(turns.begin(), turns.end(), [](const Turn& a, const Turn& b) { return a.vertex < b.vertex; });
    for (std::size_t begin = 0; begin < turns.size();) {
      std::size_t end = begin;
      while (end < turns.size() && turns[end].vertex == turns[begin].vertex) ++end;
      std::vector<std::int32_t>& sites = diagram_.vertices[static_cast<std::size_t>(turns[begin].vertex)].sites;
      std::vector<std::uint8_t> used(end - begin, 0);
      std::int32_t site = turns[begin].right;
      for (std::size_t found = 0; found < end - begin; ++found) {
        std::size_t next = begin;
        while (next < end && (used[next - begin] != 0 || turns[next].right != site)) ++next;
        if (next == end) {
          // Another round of cells about the same place.
          next = begin;
          while (used[next - begin] != 0) ++next;
        }
        used[next - begin] = 1;
        sites.push_back(turns[next].right);
        site = turns[next].left;
      }
      begin = end;
    }
  }

  void trace_cells() {
    std::vector<std::uint8_t> seen(2 * parts_.size(), 0);
    const auto count = static_cast<Way>(2 * parts_.size());
    for (Way start = 0; start < count; ++start) {
      if (seen[static_cast<std::size_t>(start)] != 0 || left_of(start) < 0) continue;
      std::vector<std::int32_t> loop;
      std::vector<std::int32_t> vertices;
      for (Way way = start; way >= 0 && seen[static_cast<std::size_t>(way)] == 0; way = boundary_after(way)) {
        seen[static_cast<std::size_t>(way)] = 1;
        const std::int32_t point = begin_of(way);
        const std::int32_t vertex = vertex_of_[static_cast<std::size_t>(point)];
        if (vertex >= 0 && (vertices.empty() || vertices.back() != vertex)) vertices.push_back(vertex);
        if (!loop.empty() && same_place(loop.back(), point)) {
          // Of points in one place a vertex stands for all.
          if (is_vertex(point)) loop.back() = point;
          continue;
        }
        loop.push_back(point);
      }
      while (loop.size() > 1 && same_place(loop.front(), loop.back())) {
        if (is_vertex(loop.back())) loop.front() = loop.back();
        loop.pop_back();
      }
      if (vertices.size() > 1 && vertices.front() == vertices.back()) vertices.pop_back();
      if (loop.size() < 2) continue;
      DiagramCell& cell = diagram_.cells[static_cast<std::size_t>(left_of(start))];
      cell.boundary.push_back(std::move(loop));
      cell.vertices.insert(cell.vertices.end(), vertices.begin(), vertices.end());
    }
    for (const DiagramEdge& edge : diagram_.edges) {
      diagram_.cells[static_cast<std::size_t>(edge.sites[0])].neighbours.push_back(edge.sites[1]);
      diagram_.cells[static_cast<std::size_t>(edge.sites[1])].neighbours.push_back(edge.sites[0]);
    }
    for (DiagramCell& cell : diagram_.cells) {
      std::sort(cell.neighbours.begin(), cell.neighbours.end());
      cell.neighbours.erase(std::unique(cell.neighbours.begin(), cell.neighbours.end()), cell.neighbours.end());
    }
  }

  bool same_place(std::int32_t a, std::int32_t b) const {
    return (place(a) - place(b)).squaredNorm() < merged_ * merged_;
  }

  void make_dual() {
    for (const DiagramVertex& vertex : diagram_.vertices)
      for (std::size_t i = 2; i < vertex.sites.size(); ++i)
        diagram_.dual.push_back({vertex.sites[0], vertex.sites[i - 1], vertex.sites[i]});
  }

  const std::vector<BorderPart>& parts_;
  double merged_;
  Diagram& diagram_;
  std::vector<std::uint8_t> has_arms_;  ///< of points that were made as Voronoi vertices: whose ways leave in order
  std::vector<std::int32_t> first_;
  std::vector<Way> leaving_;
  std::vector<DiagramEdge> traced_;
  std::vector<std::int32_t> root_;
  std::vector<std::int32_t> vertex_of_;
};

}  // namespace

void assemble_cells(const std::vector<BorderPart>& parts, double merged, Diagram& diagram) {
  Assembly(parts, merged, diagram).run();
}

}  // namespace supple::voronoi
