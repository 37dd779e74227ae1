#include "supple/surface/mesh_repair.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "equal_points.h"
#include "mesh_connectivity.h"
#include "mesh_cracks.h"
#include "mesh_faults.h"
#include "near_points.h"
#include "supple/base/error.h"
#include "supple/base/stop_pace.h"
#include "supple/surface/mesh_error.h"

namespace supple::surface {
namespace {

using Index = std::int32_t;

/// The diagonal of the bounding box of the vertices that faces use, in mesh units.
double diagonal_of(const TriangleSoup& soup) {
  Eigen::Vector3d lower = soup.positions[soup.faces[0][0]], upper = lower;
  for (const Triangle& face : soup.faces) {
    for (const Index v : face) {
      lower = lower.cwiseMin(soup.positions[v]);
      upper = upper.cwiseMax(soup.positions[v]);
    }
  }
  return (upper - lower).norm();
}

/// Drops the faces for which is_retained(f) is false, and updates `new_faces`. Returns the number of dropped faces.
template <typename Predicate>
std::int64_t drop_faces(std::vector<Triangle>& faces, std::vector<Index>& new_faces, Predicate&& is_retained) {
  std::vector<Index> new_index(faces.size(), -1);
  Index retained = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!is_retained(f)) continue;
    new_index[f] = retained;
    faces[retained++] = faces[f];
  }
  const std::int64_t dropped = static_cast<std::int64_t>(faces.size()) - retained;
  faces.resize(retained);
  for (Index& f : new_faces) {
    if (f >= 0) f = new_index[f];
  }
  return dropped;
}

/// Whether each face has the vertices of an earlier one.
std::vector<std::uint8_t> find_duplicates(const std::vector<Triangle>& faces, const Execution& execution) {
  struct Entry {
    Triangle vertices;
    Index face;
  };
  std::vector<Entry> entries;
  entries.reserve(faces.size());
  for (Index f = 0; f < static_cast<Index>(faces.size()); ++f) {
    entries.push_back({faces[f], f});
    std::sort(entries.back().vertices.begin(), entries.back().vertices.end());
  }
  sort_stoppably(entries, execution.cancellation, [](const Entry& a, const Entry& b) {
    return std::pair(a.vertices, a.face) < std::pair(b.vertices, b.face);
  });
  std::vector<std::uint8_t> duplicate(faces.size(), 0);
  for (std::size_t i = 1; i < entries.size(); ++i) {
    duplicate[entries[i].face] = entries[i].vertices == entries[i - 1].vertices;
  }
  return duplicate;
}

/// Fans of corners h = 3 f + i: the corners around a vertex whose faces are connected by edges with two faces. A fan is
/// identified by its least corner.
class CornerFans {
 public:
  CornerFans(const std::vector<Triangle>& faces, const std::vector<Index>& partners) : parents_(3 * faces.size()) {
    std::iota(parents_.begin(), parents_.end(), 0);
    const auto tail = [&](Index h) { return faces[h / 3][h % 3]; };
    for (Index h = 0; h < static_cast<Index>(parents_.size()); ++h) {
      const Index partner = partners[h];
      if (partner < h) continue;
      // The faces may traverse their edge in the same direction or in opposite ones.
      const bool same = tail(h) == tail(partner);
      unite(h, same ? partner : TriangleMesh::next(partner));
      unite(TriangleMesh::next(h), same ? TriangleMesh::next(partner) : partner);
    }
  }

  Index representative(Index corner) {
    while (parents_[corner] != corner) corner = parents_[corner] = parents_[parents_[corner]];
    return corner;
  }

 private:
  void unite(Index a, Index b) {
    a = representative(a);
    b = representative(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

  std::vector<Index> parents_;
};

/// Gives each fan of faces a vertex of its own. New vertices are numbered from `vertices` on, and `copies` receives the
/// vertex of which each is a copy.
void split_fans(std::vector<Triangle>& faces, Index vertices, std::vector<Index>& copies, RepairOutcome& outcome,
                const Execution& execution) {
  const std::vector<Index> partners = pair_manifold_halfedges(vertices, faces, outcome.split_edges, execution);
  CornerFans fans(faces, partners);
  execution.cancellation.throw_if_requested();
  // Vertex of each fan, indexed by its least corner; -1 if it has none yet.
  std::vector<Index> fan_vertices(3 * faces.size(), -1);
  std::vector<std::uint8_t> vertex_uses(vertices, 0);  // 1 once a fan uses the vertex, 2 once another fan uses a copy
  for (Index h = 0; h < static_cast<Index>(fan_vertices.size()); ++h) {
    Index& corner = faces[h / 3][h % 3];
    const Index v = corner, fan = fans.representative(h);
    if (fan_vertices[fan] < 0) {
      if (vertex_uses[v] == 0) {
        fan_vertices[fan] = v;
        vertex_uses[v] = 1;
      } else {
        outcome.split_vertices += vertex_uses[v] == 1;
        vertex_uses[v] = 2;
        fan_vertices[fan] = vertices + static_cast<Index>(copies.size());
        copies.push_back(v);
      }
    }
    corner = fan_vertices[fan];
  }
}

/// Writes for each given vertex which vertices its faces have now, or fallback_vertex(v) if no face remains. The memory
/// is at most one entry for each corner, however many vertices were welded and split in one place.
template <typename Fallback>
void write_vertex_map(const std::vector<Triangle>& given_faces, const std::vector<Triangle>& faces,
                      RepairOutcome& outcome, Fallback&& fallback_vertex) {
  const std::size_t given = outcome.vertex_starts.size() - 1;
  const auto for_each_corner = [&](auto&& visit) {
    for (std::size_t f = 0; f < given_faces.size(); ++f) {
      if (outcome.new_faces[f] < 0) continue;
      for (int i = 0; i < 3; ++i) visit(given_faces[f][i], faces[outcome.new_faces[f]][i]);
    }
  };
  std::vector<std::int64_t> starts(given + 1, 0);
  for_each_corner([&](Index from, Index) { ++starts[from + 1]; });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<std::int64_t> ends(starts.begin(), starts.end() - 1);
  std::vector<Index> targets(starts.back());
  for_each_corner([&](Index from, Index to) { targets[ends[from]++] = to; });
  for (std::size_t v = 0; v < given; ++v) {
    const auto begin = targets.begin() + starts[v];
    auto end = targets.begin() + starts[v + 1];
    std::sort(begin, end);
    end = std::unique(begin, end);
    outcome.new_vertices.insert(outcome.new_vertices.end(), begin, end);
    if (begin == end) {
      if (const Index vertex = fallback_vertex(static_cast<Index>(v)); vertex >= 0)
        outcome.new_vertices.push_back(vertex);
    }
    outcome.vertex_starts[v + 1] = static_cast<std::int64_t>(outcome.new_vertices.size());
  }
}

/// Removes the vertices that were welded to others or have lost all of their faces. Returns the new index of each
/// vertex; -1 for a removed one.
std::vector<Index> remove_vertices(TriangleSoup& soup, const std::vector<Index>& first,
                                   const std::vector<std::uint8_t>& had_faces,
                                   const std::vector<std::uint8_t>& has_faces, RepairOutcome& outcome) {
  const auto given = static_cast<Index>(soup.positions.size());
  std::vector<Index> new_index(given, -1);
  Index retained = 0;
  for (Index v = 0; v < given; ++v) {
    if (first[v] != v) {
      ++outcome.welded_vertices;
    } else if (had_faces[v] && !has_faces[v]) {
      ++outcome.removed_vertices;
    } else {
      new_index[v] = retained;
      soup.positions[retained++] = soup.positions[v];
    }
  }
  soup.positions.resize(retained);
  for (Triangle& face : soup.faces) {
    for (Index& v : face) v = new_index[v];
  }
  return new_index;
}

void check_vertex_count(std::int64_t count, const MeshLimits& limits) {
  if (count <= limits.vertices) return;
  const std::string over =
      std::to_string(count) + " vertices after the repairs, the limit is " + std::to_string(limits.vertices);
  throw MeshSizeError("mesh.too_large", "The mesh has " + over + ".", {{"vertices", over}});
}

void report_in_warnings(const RepairOutcome& outcome, std::vector<std::string>& warnings) {
  struct Row {
    std::int64_t count;
    const char* one;
    const char* many;
    const char* rest;
  };
  const Row rows[] = {
      {outcome.welded_vertices, "vertex was", "vertices were", "welded to an earlier one."},
      {outcome.dropped_degenerate_faces, "degenerate face was", "degenerate faces were", "dropped."},
      {outcome.dropped_duplicate_faces, "face with the vertices of an earlier one was",
       "faces with the vertices of an earlier one were", "dropped."},
      {outcome.split_edges, "edge of more than two faces was", "edges of more than two faces were", "cut apart."},
      {outcome.split_vertices, "vertex was", "vertices were", "duplicated, once for each further fan of faces."},
      {outcome.removed_vertices, "vertex was", "vertices were", "removed, since all of their faces were dropped."},
  };
  for (const Row& row : rows) {
    if (row.count == 0) continue;
    warnings.push_back(std::to_string(row.count) + " " + (row.count == 1 ? row.one : row.many) + " " + row.rest);
  }
}

}  // namespace

bool RepairOutcome::made(Repair repair) const {
  switch (repair) {
    case Repair::weld:
      return welded_vertices > 0;
    case Repair::drop_degenerate:
      return dropped_degenerate_faces > 0;
    case Repair::drop_duplicates:
      return dropped_duplicate_faces > 0;
    default:
      return split_edges > 0 || split_vertices > 0;
  }
}

RepairOutcome repair_mesh(TriangleSoup& soup, const RepairOptions& options, const MeshLimits& limits,
                          const Execution& execution) {
  const auto check_for_stop = [&execution] { execution.cancellation.throw_if_requested(); };
  if (const std::int64_t reset_count = reset_unused_vertices(soup.positions, soup.faces); reset_count > 0)
    soup.warnings.push_back(unused_vertices_warning(reset_count));
  check_references(soup.positions, soup.faces, execution);
  RepairOutcome outcome;
  const Index given = static_cast<Index>(soup.positions.size());
  outcome.vertex_starts.assign(static_cast<std::size_t>(given) + 1, 0);
  std::vector<Index> first(given);
  std::iota(first.begin(), first.end(), 0);
  if (options.has(Repair::weld) && !options.weld_tolerance) {
    Cracks cracks = find_cracks(soup.positions, soup.faces, MultipleEdges::joined, execution);
    outcome.weld_distance = cracks.gap;
    first = std::move(cracks.first);
  } else if (options.has(Repair::weld)) {
    outcome.weld_distance = *options.weld_tolerance * diagonal_of(soup);
    first = outcome.weld_distance > 0 ? first_near_points(soup.positions, outcome.weld_distance, execution)
                                      : first_equal_points(soup.positions, execution);
  }
  const std::vector<Triangle> given_faces = soup.faces;
  std::vector<std::uint8_t> had_faces(given, 0), has_faces(given, 0);
  for (Triangle& face : soup.faces) {
    for (Index& v : face) {
      v = first[v];
      had_faces[v] = 1;
    }
  }

  check_for_stop();
  outcome.new_faces.resize(soup.faces.size());
  std::iota(outcome.new_faces.begin(), outcome.new_faces.end(), 0);
  if (options.has(Repair::drop_degenerate)) {
    outcome.dropped_degenerate_faces = drop_faces(
        soup.faces, outcome.new_faces, [&](std::size_t f) { return !is_degenerate(soup.positions, soup.faces[f]); });
  }
  check_for_stop();
  if (options.has(Repair::drop_duplicates)) {
    const std::vector<std::uint8_t> duplicate = find_duplicates(soup.faces, execution);
    check_for_stop();
    outcome.dropped_duplicate_faces =
        drop_faces(soup.faces, outcome.new_faces, [&](std::size_t f) { return !duplicate[f]; });
  }
  if (soup.faces.empty()) {
    throw MeshSizeError("mesh.empty", "The repairs leave no face: all are degenerate.",
                        {{"faces", "are all degenerate"}});
  }
  for (const Triangle& face : soup.faces) {
    for (const Index v : face) has_faces[v] = 1;
  }

  const std::vector<Index> new_index = remove_vertices(soup, first, had_faces, has_faces, outcome);
  const auto retained = static_cast<Index>(soup.positions.size());

  std::vector<Index> copies;
  if (options.has(Repair::split_non_manifold)) {
    check_areas(soup.positions, soup.faces, execution);
    split_fans(soup.faces, retained, copies, outcome, execution);
    check_vertex_count(static_cast<std::int64_t>(retained) + static_cast<std::int64_t>(copies.size()), limits);
    for (const Index v : copies) soup.positions.push_back(soup.positions[v]);
  }

  check_for_stop();
  write_vertex_map(given_faces, soup.faces, outcome, [&](Index v) { return new_index[first[v]]; });
  report_in_warnings(outcome, soup.warnings);
  return outcome;
}

}  // namespace supple::surface
