#pragma once

#include <span>

#include "window_search.h"

namespace supple::surface {

/// Throws "geodesic.inconsistent" if distances of vertices contradict each other. A vertex is no farther from the
/// sources than a neighbour plus the edge between them. It follows that every vertex of a component with a source is
/// reached. `distances` has one entry for each vertex, infinity where unreached. Distances may be too long by the
/// factor 1 + relative_error, and distances beyond `limit` may be missing. O(faces), a few nanoseconds each, which is
/// some tenths of a per cent of the search.
void check_distances(const TriangleMesh& mesh, std::span<const double> distances, double relative_error, double limit);

/// The same for the target of a search that ends early: its path is no longer than a path by a vertex around it. The
/// distances of these vertices are lengths of paths even if the search has not finished there. O(1).
void check_target(const WindowSearch& search, const SearchTarget& target);

}  // namespace supple::surface
