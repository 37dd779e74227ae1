#pragma once

#include <span>

#include "window_search.h"

namespace supple::surface {

/// Throws "geodesic.inconsistent" if distances of vertices contradict each other: a vertex is no farther from the
/// sources than its neighbour plus the edge between them, so that also every vertex of a component that holds a source
/// is reached. `distances` is one for each vertex, infinity where unreached. Distances may be too long by the factor
/// 1 + relative_error, and need not be found beyond `limit`. O(faces), a few nanoseconds each: some tenths of a per
/// cent of the search.
void check_distances(const TriangleMesh& mesh, std::span<const double> distances, double relative_error, double limit);

/// The same for the target of a search that ends early: its path is no longer than a way by one of the vertices around
/// it, whose distances are lengths of paths whether the search has come to an end there or not. O(1).
void check_target(const WindowSearch& search, const SearchTarget& target);

}  // namespace supple::surface
