#pragma once

#include <span>
#include <vector>

#include "edge_frames.h"
#include "supple/base/execution.h"
#include "supple/surface/surface_point.h"

namespace supple::surface {

/// Upper bounds of the distances to every vertex: Dijkstra's algorithm over the mesh's edges and, across each edge
/// whose two faces unfold to a convex quadrilateral, the straight line between the opposite vertices. O(n log n).
std::vector<double> edge_graph_distances(const SearchMesh& mesh, std::span<const SurfacePoint> sources, double limit,
                                         const Execution& execution);

}  // namespace supple::surface
