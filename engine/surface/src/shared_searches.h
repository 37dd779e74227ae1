#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "supple/surface/geodesic_solver.h"

namespace supple::surface {

/// Groups of pairs that are answered by one search each, as indices of pairs. The pairs of a group have the same first
/// point. Every pair is in one group.
///
/// A directed search for one pair covers a strip from the source to the target. A search for several targets covers the
/// whole disk with the farthest target on its border. One search for all is cheaper if the disk is smaller than the
/// strips together. The cost of the disk is estimated as that of twelve strips to its border. Straight distances
/// approximate geodesic ones, and their squares approximate areas. The nearest targets share a search, as many as
/// minimize the total work. Pairs with a known path, and pairs whose ends lie on different components, are searched
/// alone. O(n log n).
std::vector<std::vector<std::size_t>> shared_searches(const TriangleMesh& mesh, std::span<const PointPair> pairs);

}  // namespace supple::surface
