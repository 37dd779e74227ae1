#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "path_assembly.h"
#include "supple/base/large_page_allocator.h"
#include "supple/surface/geodesic_field.h"

namespace supple::surface {

/// The results of a search that a field retains.
struct GeodesicField::Data {
  std::shared_ptr<const SearchMesh> mesh;
  std::vector<SurfacePoint> sources;
  std::vector<double> distances;  ///< one for each vertex
  double relative_error_bound = std::numeric_limits<double>::quiet_NaN();
  std::int64_t window_count = 0;
  bool has_windows = false;
  std::vector<VertexRecord> records;  ///< one for each vertex; empty unless has_windows
  LargeVector<Window> windows;        ///< sorted by halfedge; empty unless has_windows
  std::vector<Trail> trails;          ///< the full trails to which other trails refer; empty unless has_windows
  std::vector<TiedArrival> ties;      ///< the tied arrivals to which records refer; empty unless has_windows
  std::vector<std::int32_t> first;    ///< index of the first window of each halfedge, and the end
  /// Source of each vertex, -1 if unreached. Filled for fields with windows and for those of an edge graph.
  std::vector<std::int32_t> vertex_sources;
  /// Pairs of a face and a source in it or on an edge of it, ascending. Sources at vertices have no entry. Filled if
  /// vertex_sources is.
  std::vector<std::pair<std::int32_t, std::int32_t>> sources_in_faces;

  /// Whether the vertex has a distance that was given as known, and that none of the sources has improved.
  bool has_known_distance(std::int32_t v) const {
    return vertex_sources[v] == static_cast<std::int32_t>(sources.size());
  }

  void fill_sources_in_faces();
  /// Fills vertex_sources from the records.
  void fill_vertex_sources();
  template <typename Visit>
  void visit_sources(std::int32_t face, Visit&& visit) const {
    auto place = std::lower_bound(sources_in_faces.begin(), sources_in_faces.end(), std::pair(face, std::int32_t{-1}));
    for (; place != sources_in_faces.end() && place->first == face; ++place) visit(place->second);
  }

  SearchState state() const { return {mesh.get(), trails, records.data(), sources, ties}; }
  /// The point as a target with its best arrival.
  SearchTarget query(const SurfacePoint& point) const;
};

}  // namespace supple::surface
