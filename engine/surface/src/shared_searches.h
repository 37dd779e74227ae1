#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "supple/surface/geodesic_solver.h"

namespace supple::surface {

/// Which pairs one search answers together: indices of pairs with the same first point, or one pair alone. Every pair
/// is in one group.
///
/// A directed search for one pair looks at a strip towards its target; a search for several looks at the whole disk
/// that reaches the farthest. Sharing pays where the strips together are more than the disk, which is taken
/// to cost twelve strips to its border. Straight distances stand for geodesic ones, squares of them for areas; the
/// nearest targets share a search if that is the least work. Pairs with a known path, and such whose ends lie on
/// different components, are searched alone. O(n log n).
std::vector<std::vector<std::size_t>> shared_searches(const TriangleMesh& mesh, std::span<const PointPair> pairs);

}  // namespace supple::surface
