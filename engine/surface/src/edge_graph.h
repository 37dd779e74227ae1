#pragma once

#include <span>
#include <vector>

#include "edge_frames.h"
#include "supple/base/execution.h"
#include "supple/surface/surface_point.h"

namespace supple::surface {

/// Upper bounds of the distances of all vertices from their nearest sources, along a graph. It has the mesh's edges
/// and, across each edge whose two faces unfold to a convex quadrilateral, the straight line between the opposite
/// vertices. A vertex farther than `limit` is not reached. The search corrects labels in buckets (BucketQueue) and
/// usually takes each vertex once.
struct EdgeGraphField {
  std::vector<double> distances;             ///< per vertex; infinite if it was not reached
  std::vector<std::int32_t> vertex_sources;  ///< index of the source of each vertex; -1 if it was not reached
};
EdgeGraphField edge_graph_field(const SearchMesh& mesh, std::span<const SurfacePoint> sources, double limit,
                                const Execution& execution);

}  // namespace supple::surface
