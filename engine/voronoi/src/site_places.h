#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "supple/surface/surface_point.h"

namespace supple::voronoi {

/// Throws "voronoi.no_sites" and "voronoi.too_many_sites".
void check_site_count(std::int64_t count);

/// Of each site the first one in the same place: itself where there is none. O(n log n).
std::vector<std::int32_t> first_in_place(const surface::TriangleMesh& mesh,
                                         std::span<const surface::SurfacePoint> sites);

}  // namespace supple::voronoi
