#include "cell_assembly.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace supple::voronoi {
namespace {

using Kind = DiagramPoint::Kind;

class CellAssembly {
 public:
  CellAssembly(const std::vector<BorderPart>& parts, double merge_distance, Diagram& diagram)
      : parts_(parts), merge_distance_(merge_distance), diagram_(diagram) {
    for (const DiagramPoint& point : diagram.points) vertex_flags_.push_back(point.kind == Kind::vertex ? 1 : 0);
  }

  void run() {
    sort_half_edges();
    trace_edges();
    merge_vertices();
    make_vertices();
    trace_cells();
    make_dual();
  }

 private:
  /// A half-edge: a part of a border in its direction (2 i) or in the opposite one (2 i + 1).
  using HalfEdge = std::int32_t;
  const BorderPart& part(HalfEdge half_edge) const { return parts_[static_cast<std::size_t>(half_edge / 2)]; }
  std::int32_t begin_of(HalfEdge half_edge) const {
    return half_edge % 2 == 0 ? part(half_edge).from : part(half_edge).to;
  }
  std::int32_t end_of(HalfEdge half_edge) const {
    return half_edge % 2 == 0 ? part(half_edge).to : part(half_edge).from;
  }
  std::int32_t left_of(HalfEdge half_edge) const {
    return half_edge % 2 == 0 ? part(half_edge).left : part(half_edge).right;
  }
  std::int32_t right_of(HalfEdge half_edge) const {
    return half_edge % 2 == 0 ? part(half_edge).right : part(half_edge).left;
  }
  bool is_border(HalfEdge half_edge) const { return part(half_edge).right >= 0; }
  bool is_vertex(std::int32_t point) const { return vertex_flags_[static_cast<std::size_t>(point)] != 0; }
  const Eigen::Vector3d& place(std::int32_t point) const {
    return diagram_.points[static_cast<std::size_t>(point)].position;
  }

  /// Sorts the half-edges by the points that they leave, those of one point in the order of the parts.
  void sort_half_edges() {
    offsets_.assign(diagram_.points.size() + 1, 0);
    const auto count = static_cast<HalfEdge>(2 * parts_.size());
    for (HalfEdge half_edge = 0; half_edge < count; ++half_edge)
      ++offsets_[static_cast<std::size_t>(begin_of(half_edge)) + 1];
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    outgoing_.resize(static_cast<std::size_t>(count));
    std::vector<std::int32_t> next(offsets_.begin(), offsets_.end() - 1);
    for (HalfEdge half_edge = 0; half_edge < count; ++half_edge)
      outgoing_[static_cast<std::size_t>(next[static_cast<std::size_t>(begin_of(half_edge))]++)] = half_edge;
  }

  /// The range of a point's outgoing half-edges in outgoing_.
  std::pair<std::int32_t, std::int32_t> outgoing(std::int32_t point) const {
    return {offsets_[static_cast<std::size_t>(point)], offsets_[static_cast<std::size_t>(point) + 1]};
  }

  static HalfEdge twin(HalfEdge half_edge) { return half_edge ^ 1; }

  /// The next half-edge along a border; -1 at a Voronoi vertex and at the mesh's boundary.
  HalfEdge border_after(HalfEdge half_edge) const {
    const std::int32_t point = end_of(half_edge);
    if (is_vertex(point)) return -1;
    const auto [begin, end] = outgoing(point);
    for (std::int32_t i = begin; i < end; ++i) {
      const HalfEdge next = outgoing_[static_cast<std::size_t>(i)];
      if (next != twin(half_edge) && is_border(next)) return next;
    }
    return -1;
  }

  /// The next half-edge along the boundary of the cell on the left.
  HalfEdge boundary_after(HalfEdge half_edge) const {
    const std::int32_t point = end_of(half_edge);
    const auto [begin, end] = outgoing(point);
    if (is_vertex(point)) {
      HalfEdge only = -1;
      int count = 0;
      for (std::int32_t i = begin; i < end; ++i) {
        const HalfEdge next = outgoing_[static_cast<std::size_t>(i)];
        if (left_of(next) != left_of(half_edge)) continue;
        only = next;
        ++count;
      }
      if (count == 1) return only;
      // A cell meets the vertex more than once: the next half-edge clockwise has the cell between itself and this one.
      for (std::int32_t i = begin; i < end; ++i)
        if (outgoing_[static_cast<std::size_t>(i)] == twin(half_edge))
          return outgoing_[static_cast<std::size_t>(i == begin ? end - 1 : i - 1)];
    }
    for (std::int32_t i = begin; i < end; ++i) {
      const HalfEdge next = outgoing_[static_cast<std::size_t>(i)];
      if (next != twin(half_edge) && left_of(next) == left_of(half_edge)) return next;
    }
    return -1;
  }

  void trace_edges() {
    std::vector<std::uint8_t> visited(parts_.size(), 0);
    const auto trace = [&](HalfEdge start) {
      DiagramEdge edge;
      edge.sites = {left_of(start), right_of(start)};
      edge.points.push_back(begin_of(start));
      for (HalfEdge half_edge = start; half_edge >= 0; half_edge = border_after(half_edge)) {
        if (visited[static_cast<std::size_t>(half_edge / 2)] != 0) break;
        visited[static_cast<std::size_t>(half_edge / 2)] = 1;
        edge.points.push_back(end_of(half_edge));
        edge.length += part(half_edge).length;
      }
      traced_edges_.push_back(std::move(edge));
    };
    const auto count = static_cast<HalfEdge>(2 * parts_.size());
    const auto is_start = [&](HalfEdge half_edge) {
      if (!is_border(half_edge)) return false;
      return is_vertex(begin_of(half_edge)) || border_after(twin(half_edge)) < 0;
    };
    for (HalfEdge half_edge = 0; half_edge < count; ++half_edge)
      if (visited[static_cast<std::size_t>(half_edge / 2)] == 0 && is_start(half_edge)) trace(half_edge);
    for (HalfEdge half_edge = 0; half_edge < count; half_edge += 2)
      if (visited[static_cast<std::size_t>(half_edge / 2)] == 0 && is_border(half_edge)) trace(half_edge);
  }

  std::int32_t root(std::int32_t point) {
    std::int32_t& parent = root_[static_cast<std::size_t>(point)];
    return parent == point ? point : parent = root(parent);
  }

  /// Merges Voronoi vertices that are closer than the merge distance, by union-find.
  void merge_vertices() {
    root_.resize(diagram_.points.size());
    std::iota(root_.begin(), root_.end(), 0);
    for (const DiagramEdge& edge : traced_edges_) {
      const std::int32_t a = edge.points.front();
      const std::int32_t b = edge.points.back();
      if (edge.length < merge_distance_ && is_vertex(a) && is_vertex(b))
        root_[static_cast<std::size_t>(root(a))] = root(b);
    }
  }

  /// Writes the vertices with their sites in order, and the remaining edges.
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
    for (DiagramEdge& edge : traced_edges_) {
      const std::int32_t a = vertex_of_[static_cast<std::size_t>(edge.points.front())];
      const std::int32_t b = vertex_of_[static_cast<std::size_t>(edge.points.back())];
      if (edge.length < merge_distance_ && a == b)
        continue;  // an edge within a merged vertex, or one of no length where a tie ends
      edge.vertices = {a, b};
      diagram_.edges.push_back(std::move(edge));
    }
    dissolve_degree_two_vertices();
    order_sites();
    // A vertex without sites has only edges of no length and is removed.
    std::vector<std::int32_t> new_index(diagram_.vertices.size(), -1);
    std::vector<DiagramVertex> remaining;
    for (std::size_t i = 0; i < diagram_.vertices.size(); ++i) {
      if (diagram_.vertices[i].sites.empty()) continue;
      new_index[i] = static_cast<std::int32_t>(remaining.size());
      remaining.push_back(std::move(diagram_.vertices[i]));
    }
    diagram_.vertices = std::move(remaining);
    for (std::int32_t& vertex : vertex_of_)
      if (vertex >= 0) vertex = new_index[static_cast<std::size_t>(vertex)];
    for (DiagramEdge& edge : diagram_.edges)
      for (std::int32_t& vertex : edge.vertices)
        if (vertex >= 0) vertex = new_index[static_cast<std::size_t>(vertex)];
  }

  /// Joins the two edges at each vertex of degree two. Ties leave such vertices behind where borders run along edges of
  /// the mesh.
  void dissolve_degree_two_vertices() {
    std::vector<std::vector<std::int32_t>> incident_edges(diagram_.vertices.size());
    for (std::size_t i = 0; i < diagram_.edges.size(); ++i)
      for (const std::int32_t vertex : diagram_.edges[i].vertices)
        if (vertex >= 0) incident_edges[static_cast<std::size_t>(vertex)].push_back(static_cast<std::int32_t>(i));
    for (std::size_t v = 0; v < incident_edges.size(); ++v) {
      if (incident_edges[v].size() != 2) continue;
      const auto vertex = static_cast<std::int32_t>(v);
      DiagramEdge& first = diagram_.edges[static_cast<std::size_t>(incident_edges[v][0])];
      if (incident_edges[v][0] == incident_edges[v][1]) {
        first.vertices = {-1, -1};
        continue;
      }
      DiagramEdge& second = diagram_.edges[static_cast<std::size_t>(incident_edges[v][1])];
      if (first.vertices[1] != vertex) reverse_edge(first);
      if (second.vertices[0] != vertex) reverse_edge(second);
      first.points.insert(first.points.end(), second.points.begin() + 1, second.points.end());
      first.length += second.length;
      first.vertices[1] = second.vertices[1];
      if (second.vertices[1] >= 0) {
        std::vector<std::int32_t>& there = incident_edges[static_cast<std::size_t>(second.vertices[1])];
        std::replace(there.begin(), there.end(), incident_edges[v][1], incident_edges[v][0]);
      }
      second.points.clear();
    }
    diagram_.edges.erase(std::remove_if(diagram_.edges.begin(), diagram_.edges.end(),
                                        [](const DiagramEdge& edge) { return edge.points.empty(); }),
                         diagram_.edges.end());
    for (std::size_t i = 0; i < vertex_of_.size(); ++i) {
      if (vertex_of_[i] < 0 || incident_edges[static_cast<std::size_t>(vertex_of_[i])].size() != 2) continue;
      vertex_of_[i] = -1;
      diagram_.points[i].kind = Kind::inner;
    }
  }

  static void reverse_edge(DiagramEdge& edge) {
    std::reverse(edge.points.begin(), edge.points.end());
    std::swap(edge.sites[0], edge.sites[1]);
    std::swap(edge.vertices[0], edge.vertices[1]);
  }

  void order_sites() {
    // Around a vertex, counterclockwise: the site on the left of an outgoing edge follows the site on its right.
    struct EdgeEnd {
      std::int32_t vertex, right, left;
    };
    std::vector<EdgeEnd> edge_ends;
    for (const DiagramEdge& edge : diagram_.edges) {
      if (edge.vertices[0] >= 0) edge_ends.push_back({edge.vertices[0], edge.sites[1], edge.sites[0]});
      if (edge.vertices[1] >= 0) edge_ends.push_back({edge.vertices[1], edge.sites[0], edge.sites[1]});
    }
    std::stable_sort(edge_ends.begin(), edge_ends.end(),
                     [](const EdgeEnd& a, const EdgeEnd& b) { return a.vertex < b.vertex; });
    for (std::size_t begin = 0; begin < edge_ends.size();) {
      std::size_t end = begin;
      while (end < edge_ends.size() && edge_ends[end].vertex == edge_ends[begin].vertex) ++end;
      std::vector<std::int32_t>& sites = diagram_.vertices[static_cast<std::size_t>(edge_ends[begin].vertex)].sites;
      std::vector<std::uint8_t> used(end - begin, 0);
      std::int32_t site = edge_ends[begin].right;
      for (std::size_t found = 0; found < end - begin; ++found) {
        std::size_t next = begin;
        while (next < end && (used[next - begin] != 0 || edge_ends[next].right != site)) ++next;
        if (next == end) {
          // Another cycle of cells around the same point.
          next = begin;
          while (used[next - begin] != 0) ++next;
        }
        used[next - begin] = 1;
        sites.push_back(edge_ends[next].right);
        site = edge_ends[next].left;
      }
      begin = end;
    }
  }

  void trace_cells() {
    std::vector<std::uint8_t> visited(2 * parts_.size(), 0);
    const auto count = static_cast<HalfEdge>(2 * parts_.size());
    for (HalfEdge start = 0; start < count; ++start) {
      if (visited[static_cast<std::size_t>(start)] != 0 || left_of(start) < 0) continue;
      std::vector<std::int32_t> curve;
      std::vector<std::int32_t> vertices;
      for (HalfEdge half_edge = start; half_edge >= 0 && visited[static_cast<std::size_t>(half_edge)] == 0;
           half_edge = boundary_after(half_edge)) {
        visited[static_cast<std::size_t>(half_edge)] = 1;
        const std::int32_t point = begin_of(half_edge);
        const std::int32_t vertex = vertex_of_[static_cast<std::size_t>(point)];
        if (vertex >= 0 && (vertices.empty() || vertices.back() != vertex)) vertices.push_back(vertex);
        if (!curve.empty() && same_place(curve.back(), point)) {
          // A Voronoi vertex represents all points that coincide with it.
          if (is_vertex(point)) curve.back() = point;
          continue;
        }
        curve.push_back(point);
      }
      while (curve.size() > 1 && same_place(curve.front(), curve.back())) {
        if (is_vertex(curve.back())) curve.front() = curve.back();
        curve.pop_back();
      }
      if (vertices.size() > 1 && vertices.front() == vertices.back()) vertices.pop_back();
      if (curve.size() < 2) continue;
      DiagramCell& cell = diagram_.cells[static_cast<std::size_t>(left_of(start))];
      cell.boundary.push_back(std::move(curve));
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
    return (place(a) - place(b)).squaredNorm() < merge_distance_ * merge_distance_;
  }

  void make_dual() {
    for (const DiagramVertex& vertex : diagram_.vertices)
      for (std::size_t i = 2; i < vertex.sites.size(); ++i)
        diagram_.dual.push_back({vertex.sites[0], vertex.sites[i - 1], vertex.sites[i]});
  }

  const std::vector<BorderPart>& parts_;
  double merge_distance_;
  Diagram& diagram_;
  std::vector<std::uint8_t> vertex_flags_;  ///< nonzero for points of the kind `vertex`
  std::vector<std::int32_t> offsets_;       ///< for each point the index of its first half-edge in outgoing_
  std::vector<HalfEdge> outgoing_;
  std::vector<DiagramEdge> traced_edges_;
  std::vector<std::int32_t> root_;       ///< parents of points in the union-find structure of merged vertices
  std::vector<std::int32_t> vertex_of_;  ///< Voronoi vertex of each point, -1 if there is none
};

}  // namespace

void assemble_cells(const std::vector<BorderPart>& parts, double merge_distance, Diagram& diagram) {
  CellAssembly(parts, merge_distance, diagram).run();
}

}  // namespace supple::voronoi
