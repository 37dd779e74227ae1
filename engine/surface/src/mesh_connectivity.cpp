#include "mesh_connectivity.h"

#include <algorithm>
#include <utility>

#include "mesh_faults.h"
#include "supple/base/stop_pace.h"
#include "supple/surface/mesh_error.h"

namespace supple::surface {
namespace {

using Index = std::int32_t;

Index tail(const std::vector<Triangle>& faces, Index h) { return faces[h / 3][h % 3]; }
Index head(const std::vector<Triangle>& faces, Index h) { return faces[h / 3][(h + 1) % 3]; }

// Whether the two faces of an edge traverse it in opposite directions, as neighbours of equal orientation do.
bool agree(const std::vector<Triangle>& faces, Index h, Index partner) {
  return tail(faces, h) == head(faces, partner);
}

// The new number of h if its face (a, b, c) is turned into (a, c, b), which reverses the order of the three edges.
Index turned_halfedge(Index h) { return h - h % 3 + (2 - h % 3); }

/// Pairs the halfedges of edges with two faces. Calls report(v, w, halfedges) for each edge with more, v < w.
template <typename Report>
std::vector<Index> pair_or_report(Index vertex_count, const std::vector<Triangle>& faces, const Execution& execution,
                                  Report&& report) {
  StopPace pace(execution.cancellation);
  // Counting sort by the smaller vertex of each edge, then a small sort by the larger. This is faster than sorting all
  // edges.
  struct Entry {
    Index larger;
    Index halfedge;
  };
  const Index halfedge_count = static_cast<Index>(3 * faces.size());
  std::vector<Index> starts(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (Index h = 0; h < halfedge_count; ++h) {
    pace.check();
    ++starts[std::min(tail(faces, h), head(faces, h)) + 1];
  }
  for (Index v = 0; v < vertex_count; ++v) starts[v + 1] += starts[v];
  std::vector<Entry> entries(halfedge_count);
  std::vector<Index> ends(starts.begin(), starts.end() - 1);
  for (Index h = 0; h < halfedge_count; ++h) {
    pace.check();
    const auto [smaller, larger] = std::minmax({tail(faces, h), head(faces, h)});
    entries[ends[smaller]++] = {larger, h};
  }

  std::vector<Index> partners(halfedge_count, -1), edge_halfedges;
  for (Index v = 0; v < vertex_count; ++v) {
    pace.check();
    const auto first = entries.begin() + starts[v], last = entries.begin() + starts[v + 1];
    std::sort(first, last, [](const Entry& a, const Entry& b) {
      return std::pair(a.larger, a.halfedge) < std::pair(b.larger, b.halfedge);
    });
    for (auto it = first; it != last;) {
      const auto group_end = std::find_if(it, last, [&](const Entry& e) { return e.larger != it->larger; });
      if (group_end - it == 2) {
        partners[it[0].halfedge] = it[1].halfedge;
        partners[it[1].halfedge] = it[0].halfedge;
      } else if (group_end - it > 2) {
        edge_halfedges.clear();
        for (auto entry = it; entry != group_end; ++entry) edge_halfedges.push_back(entry->halfedge);
        report(v, it->larger, edge_halfedges);
      }
      it = group_end;
    }
  }
  return partners;
}

}  // namespace

std::vector<Index> pair_halfedges(Index vertex_count, const std::vector<Triangle>& faces, const Execution& execution) {
  FaultList faults;
  auto partners =
      pair_or_report(vertex_count, faces, execution, [&](Index v, Index w, const std::vector<Index>& halfedges) {
        faults.add([&]() -> Error::Detail {
          return {name_of_edge(v, w), "is shared by " + std::to_string(halfedges.size()) + " faces"};
        });
      });
  faults.throw_if_any<RepairableFault>("mesh.non_manifold_edge", "edge is shared by more than two faces",
                                       "edges are shared by more than two faces");
  return partners;
}

std::vector<Index> pair_manifold_halfedges(Index vertex_count, const std::vector<Triangle>& faces,
                                           std::int64_t& non_manifold_edges, const Execution& execution) {
  return pair_or_report(vertex_count, faces, execution,
                        [&](Index, Index, const std::vector<Index>&) { ++non_manifold_edges; });
}

Orientation orient_faces(std::vector<Triangle>& faces, std::vector<Index>& partners, const Execution& execution) {
  StopPace pace(execution.cancellation);
  const Index face_count = static_cast<Index>(faces.size());
  Orientation result;
  result.components.assign(face_count, -1);
  std::vector<std::uint8_t> is_turned(face_count, 0);
  std::vector<Index> queue;
  queue.reserve(face_count);
  FaultList faults;
  for (Index seed = 0; seed < face_count; ++seed) {
    if (result.components[seed] >= 0) continue;
    const std::size_t first = queue.size();
    std::int64_t turned = 0;
    result.components[seed] = result.component_count;
    queue.push_back(seed);
    for (std::size_t next = first; next < queue.size(); ++next) {
      pace.check();
      const Index f = queue[next];
      for (Index h = 3 * f; h < 3 * f + 3; ++h) {
        const Index partner = partners[h];
        if (partner < 0) continue;
        const Index g = partner / 3;
        const std::uint8_t wanted = is_turned[f] ^ static_cast<std::uint8_t>(!agree(faces, h, partner));
        if (result.components[g] < 0) {
          result.components[g] = result.component_count;
          is_turned[g] = wanted;
          turned += wanted;
          queue.push_back(g);
        } else if (is_turned[g] != wanted && h < partner) {
          faults.add([&]() -> Error::Detail {
            return {name_of_edge(tail(faces, h), head(faces, h)),
                    "is where faces " + std::to_string(f) + " and " + std::to_string(g) + " cannot be made to agree"};
          });
        }
      }
    }
    const std::int64_t size = static_cast<std::int64_t>(queue.size() - first);
    if (2 * turned > size) {
      for (std::size_t i = first; i < queue.size(); ++i) is_turned[queue[i]] ^= 1;
      turned = size - turned;
    }
    result.turned_faces += turned;
    ++result.component_count;
  }
  faults.throw_if_any<RepairableFault>("mesh.not_orientable", "edge keeps the surface from being oriented",
                                       "edges keep the surface from being oriented");
  if (result.turned_faces == 0) return result;

  std::vector<Index> renumbered(partners.size());
  const auto new_index = [&](Index h) { return is_turned[h / 3] ? turned_halfedge(h) : h; };
  for (Index h = 0; h < static_cast<Index>(partners.size()); ++h) {
    renumbered[new_index(h)] = partners[h] < 0 ? -1 : new_index(partners[h]);
  }
  partners = std::move(renumbered);
  for (Index f = 0; f < face_count; ++f) {
    if (is_turned[f]) std::swap(faces[f][1], faces[f][2]);
  }
  return result;
}

std::vector<Index> find_fans(Index vertex_count, const std::vector<Triangle>& faces, const std::vector<Index>& twins,
                             const Execution& execution) {
  StopPace pace(execution.cancellation);
  const Index halfedge_count = static_cast<Index>(3 * faces.size());
  std::vector<Index> outgoing(vertex_count, -1), degree(vertex_count, 0);
  for (Index h = 0; h < halfedge_count; ++h) {
    pace.check();
    const Index v = tail(faces, h);
    ++degree[v];
    if (outgoing[v] < 0 || twins[h] < 0) outgoing[v] = h;
  }
  FaultList faults;
  for (Index v = 0; v < vertex_count; ++v) {
    pace.check();
    Index visited = 0;
    Index h = outgoing[v];
    while (h >= 0 && visited < degree[v]) {
      ++visited;
      h = twins[TriangleMesh::previous(h)];
      if (h == outgoing[v]) break;
    }
    if (visited == degree[v]) continue;
    faults.add([&]() -> Error::Detail {
      return {name_of_vertex(v), "joins fans of faces that share no edge there (" + std::to_string(visited) + " of " +
                                     std::to_string(degree[v]) + " faces form the first)"};
    });
  }
  faults.throw_if_any<RepairableFault>("mesh.non_manifold_vertex", "vertex joins fans of faces that share no edge",
                                       "vertices join fans of faces that share no edge");
  return outgoing;
}

}  // namespace supple::surface
