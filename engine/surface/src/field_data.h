#pragma once

#include <limits>

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
  std::vector<std::int32_t> first;    ///< per halfedge, where the windows that enter its face begin, and the end

  SearchState state() const { return {mesh.get(), trails, records.data(), sources}; }
  /// The target with its best arrival.
  SearchTarget query(const SurfacePoint& point) const;
};

}  // namespace supple::surface
