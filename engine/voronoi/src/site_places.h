#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/surface/surface_point.h"

namespace supple::voronoi {

/// Throws "voronoi.no_sites" and "voronoi.too_many_sites".
void check_site_count(std::int64_t count);

/// For each site the first one in the same place: itself where there is none before it. O(n log n), however many are in
/// one place; where sheets of the surface touch in space, times the number of sheets. Throws what the token does.
std::vector<std::int32_t> first_in_place(const surface::TriangleMesh& mesh,
                                         std::span<const surface::SurfacePoint> sites,
                                         const CancellationToken& cancellation);

}  // namespace supple::voronoi
