#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/surface/surface_point.h"

namespace supple::voronoi {

/// Throws "voronoi.no_sites" and "voronoi.too_many_sites".
void check_site_count(std::int64_t count);

/// For each site the first site in the same place, which is itself if there is none before it. O(n log n), however many
/// sites coincide. Where sheets of the surface touch in space, the cost is multiplied by their number. Throws what the
/// token throws.
std::vector<std::int32_t> first_in_place(const surface::TriangleMesh& mesh,
                                         std::span<const surface::SurfacePoint> sites,
                                         const CancellationToken& cancellation);

}  // namespace supple::voronoi
