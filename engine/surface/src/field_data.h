#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "path_assembly.h"
#include "supple/surface/geodesic_field.h"

namespace supple::surface {

/// What a field keeps of the search that made it.
struct GeodesicField::Data {
  std::shared_ptr<const SearchMesh> mesh;
  std::vector<SurfacePoint> sources;
  std::vector<double> distances;  ///< per vertex
  double relative_error_bound = std::numeric_limits<double>::quiet_NaN();
  std::int64_t window_count = 0;
  bool kept = false;
  std::vector<VertexRecord> records;  ///< per vertex; empty unless kept
  LargeVector<Window> windows;        ///< empty unless kept
  std::vector<Trail> trails;          ///< the full ones that others refer to; empty unless kept
  std::vector<TiedArrival> ties;      ///< that records refer to; empty unless kept
  std::vector<std::int32_t> first;    ///< per halfedge, where the windows that enter its face begin, and the end
  std::vector<std::int32_t>
      vertex_sources;  ///< per vertex the source, -1 if unreached; empty unless kept or edge_graph
  /// Of each source that is at no vertex its face, or both faces of its edge; ascending. Filled where vertex_sources
  /// is.
  std::vector<std::pair<std::int32_t, std::int32_t>> sources_in_faces;

  /// Whether the vertex has a distance that was known before, which none of the sources has improved.
  bool is_known(std::int32_t v) const { return vertex_sources[v] == static_cast<std::int32_t>(sources.size()); }

  /// Fills sources_in_faces.
  void sort_sources();
  /// Fills vertex_sources from the records.
  void follow_records();
  template <typename Visit>
  void visit_sources(std::int32_t face, Visit&& visit) const {
    auto place = std::lower_bound(sources_in_faces.begin(), sources_in_faces.end(), std::pair(face, std::int32_t{-1}));
    for (; place != sources_in_faces.end() && place->first == face; ++place) visit(place->second);
  }

  SearchState state() const { return {mesh.get(), trails, records.data(), sources, ties}; }
  /// The target with its best arrival.
  SearchTarget query(const SurfacePoint& point) const;
};

}  // namespace supple::surface
