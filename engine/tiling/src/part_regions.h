#pragma once

#include <string>
#include <vector>

#include "clipper_paths.h"
#include "supple/tiling/part.h"

namespace supple::tiling {

/// The areas that the fillings of a part fill; they do not overlap.
struct PartAreas {
  ClipperLib::Paths outline;
  std::vector<ClipperLib::Paths> regions;  ///< for each region, what no later region covers
  ClipperLib::Paths rest;                  ///< what lies outside all regions
};

/// Divides the outline of a design among its regions. Throws "tiling.part" if the outline is the union of the regions
/// and they are not one piece.
PartAreas areas_of(const PartDesign& design);

/// The area within an odd number of polygons, which may overlap in any way.
ClipperLib::Paths even_odd(const std::vector<Polygon>& polygons);

/// The area in mm^2.
double area_of(const ClipperLib::Paths& paths);

/// Whether two corners of the solid coincide.
bool has_touching_corners(const ClipperLib::Paths& paths);

/// Distance by which corners that touch recede on either side, mm: less than any printer or laser resolves.
inline constexpr double corner_recess = 2e-3;

/// The solid divided among the regions of a design and the rest, without pieces narrower than `min_width` (mm) and
/// sides shorter than it. Empty if there are no regions.
std::vector<RegionSolid> divided(const SolidFace& solid, const PartDesign& design, const PartAreas& areas,
                                 double min_width);

}  // namespace supple::tiling
