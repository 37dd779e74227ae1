#include "supple/tiling/part.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "clipper_paths.h"
#include "narrow_places.h"
#include "neck_repair.h"
#include "part_regions.h"
#include "part_tasks.h"
#include "polygon.h"
#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

using ClipperLib::Paths;

constexpr double max_size = 2000;       // mm
constexpr double max_thickness = 1000;  // mm
constexpr std::size_t max_tiles = 50'000;
/// Limit of the corners of outlines, since the search for self-crossings compares all pairs of sides.
constexpr std::size_t max_corners = 5'000;
/// Length, in beam widths, below which sides become points, as in other files.
constexpr double min_part_side = 0.005;
/// Limit of the repairs. Repairing a neck may leave others beside it.
constexpr int max_repairs = 8;
/// Radius of the disk that must fit into a wall, as a ratio to the smallest wall. Walls into which it does not fit are
/// narrow.
constexpr double disk_radius = 0.49;
/// A point within this distance of where the disk fits, as a ratio to the smallest wall, belongs to a corner and not to
/// a narrow wall.
constexpr double corner_distance = 0.25;

void check_polygon(const Polygon& polygon, const std::string& place, Faults& faults) {
  if (polygon.size() < 3) return faults.add(place, "must have at least 3 corners");
  for (const auto& p : polygon) {
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > max_size)
      return faults.add(place, "must have coordinates from -2000 to 2000 mm");
  }
  if (const auto crossing = self_intersection(polygon)) {
    faults.add(place, "crosses or touches itself: its sides " + std::to_string(crossing->first) + " and " +
                          std::to_string(crossing->second) + " meet");
  }
}

void check_length(double value, double lower, double upper, const std::string& place, Faults& faults) {
  faults.require(value >= lower && value <= upper, place,
                 "must be from " + number_text(lower) + " to " + number_text(upper) + " mm, got " + number_text(value));
}

void check_filling(const Filling& filling, const PartDesign& design, const std::string& folder, Faults& faults) {
  check_length(filling.beam_width, 0.01, 100, folder + "beam_width", faults);
  faults.require(design.smallest_wall <= filling.beam_width, "smallest_wall",
                 "must be at most the width of the beams, " + number_text(filling.beam_width) + " mm, got " +
                     number_text(design.smallest_wall));
}

std::size_t corners_of(const PartDesign& design) {
  std::size_t corners = 0;
  for (const Polygon& polygon : design.outline) corners += polygon.size();
  for (const PartRegion& region : design.regions) corners += region.outline.size();
  return corners;
}

void check(const PartDesign& design) {
  Faults faults;
  const std::size_t corners = corners_of(design);
  faults.require(corners <= max_corners, "outline",
                 "must have at most " + std::to_string(max_corners) + " corners together with all regions, got " +
                     std::to_string(corners));
  faults.throw_if_any<PartError>("tiling.part", "The part");
  faults.require(!design.outline.empty() || design.outline_of_regions, "outline", "must have at least one polygon");
  faults.require(!design.regions.empty() || !design.outline_of_regions, "outline", "needs at least one region");
  for (std::size_t i = 0; i < design.outline.size(); ++i)
    check_polygon(design.outline[i], "outline/" + std::to_string(i), faults);
  for (std::size_t i = 0; i < design.solids.size(); ++i)
    check_polygon(design.solids[i], "solids/" + std::to_string(i), faults);
  check_length(design.frame, 0, max_size, "frame", faults);
  check_length(design.seam, 0, max_size, "seam", faults);
  check_length(design.smallest_wall, 0, 100, "smallest_wall", faults);
  check_length(design.thickness, 1e-3, max_thickness, "thickness", faults);
  check_filling(design.filling, design, "", faults);
  for (std::size_t i = 0; i < design.regions.size(); ++i) {
    const std::string folder = "regions/" + std::to_string(i) + "/";
    check_polygon(design.regions[i].outline, folder + "outline", faults);
    check_filling(design.regions[i].filling, design, folder, faults);
  }
  faults.throw_if_any<PartError>("tiling.part", "The part");
}

/// The tiles of a filling, rotated and scaled, whose beams may reach into a box.
std::vector<Polygon> tiles_over(const Filling& filling, const Bounds& box, const Eigen::Vector2d& centre) {
  const double scale = filling.beam_width / filling.structure.beam_width;
  const Eigen::Matrix2d transform = Eigen::Rotation2Dd(filling.orientation).toRotationMatrix() * scale;
  const Tiling& tiling = filling.structure.tiling;
  const Eigen::Matrix2d lattice = transform * tiling.lattice;
  std::vector<Polygon> cell;
  Bounds cell_bounds;
  for (const Placement& placement : tiling.placements) {
    cell.push_back(placed(tiling.tiles[static_cast<std::size_t>(placement.tile)], placement));
    for (auto& p : cell.back()) p = transform * p;
    cell_bounds.include(cell.back());
  }
  // The range of the cells (a, b) whose tiles may meet the box follows from the corners of the box, extended by the
  // bounds of a cell, in lattice coordinates.
  const Eigen::Matrix2d inverse = lattice.inverse();
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(INFINITY), upper = -lower;
  for (int corner_number = 0; corner_number < 4; ++corner_number) {
    const bool right = corner_number % 2 == 1, top = corner_number / 2 == 1;
    const Eigen::Vector2d p(right ? box.upper.x() - cell_bounds.lower.x() : box.lower.x() - cell_bounds.upper.x(),
                            top ? box.upper.y() - cell_bounds.lower.y() : box.lower.y() - cell_bounds.upper.y());
    const Eigen::Vector2d at = inverse * (p - centre);
    lower = lower.cwiseMin(at);
    upper = upper.cwiseMax(at);
  }
  const Eigen::Vector2d first = lower.array().floor(), last = upper.array().ceil();
  const Eigen::Vector2d counts = last - first + Eigen::Vector2d::Ones();
  // The limit here is generous: if the lattice is oblique to the box, half of these cells or fewer meet it.
  if (!(counts.prod() * static_cast<double>(cell.size()) <= 20.0 * max_tiles)) {
    throw PartError("tiling.part", "The part would have more than 50000 tiles: widen the beams or make it smaller.",
                    {{"beam_width", "more than 50000 tiles would fill the part"}});
  }
  std::vector<Polygon> tiles;
  const auto rows = static_cast<std::int64_t>(counts.y()), columns = static_cast<std::int64_t>(counts.x());
  for (std::int64_t b = 0; b < rows; ++b) {
    for (std::int64_t a = 0; a < columns; ++a) {
      const Eigen::Vector2d offset =
          centre + lattice * (first + Eigen::Vector2d(static_cast<double>(a), static_cast<double>(b)));
      for (const Polygon& tile : cell) {
        Polygon copy = moved(tile, offset);
        if (!bounds_of(copy).meet(box, filling.beam_width)) continue;
        tiles.push_back(std::move(copy));
        if (tiles.size() > max_tiles) {
          throw PartError("tiling.part",
                          "The part would have more than 50000 tiles: widen the beams or make it smaller.",
                          {{"beam_width", "more than 50000 tiles would fill the part"}});
        }
      }
    }
  }
  return tiles;
}

Bounds bounds_of_paths(const Paths& paths) {
  Bounds bounds;
  for (const auto& path : paths) bounds.include(to_polygon(path));
  return bounds;
}

/// The tiles that lie within an area, at least half a beam width away from its outline.
std::vector<Polygon> tiles_within(std::vector<Polygon> tiles, const Paths& area, double beam_width) {
  const Paths inner = grown(area, -beam_width / 2, ClipperLib::jtMiter);
  std::erase_if(tiles, [&](const Polygon& tile) {
    const Paths outside = operation(ClipperLib::ctDifference, {to_path(tile)}, inner);
    return std::abs(area_of(outside)) > 1e-9 * beam_width * beam_width;
  });
  return tiles;
}

/// The beams of a filling within an area.
Paths filled(const Filling& filling, const Paths& area, const Eigen::Vector2d& centre, Rim rim) {
  if (area.empty()) return {};
  std::vector<Polygon> tiles = tiles_over(filling, bounds_of_paths(area), centre);
  std::vector<Polygon> beams;
  const auto add = [&](const std::vector<Polygon>& outlines, Joints joints) {
    for (const Polygon& outline : outlines) {
      for (Polygon& beam : beams_along(outline, filling.beam_width / 2, joints)) beams.push_back(std::move(beam));
    }
  };
  if (rim == Rim::whole) tiles = tiles_within(std::move(tiles), area, filling.beam_width);
  add(tiles, Joints::left);
  if (rim == Rim::whole) {
    add(outlines_of_union(tiles), Joints::both);
    return operation(ClipperLib::ctUnion, to_paths(beams), {});
  }
  return operation(ClipperLib::ctIntersection, to_paths(beams), area);
}

/// The solid without walls and tips that are narrower than `wall`.
Paths trimmed(const Paths& solid, double wall, double& trimmed_area) {
  if (wall <= 0) return solid;
  const Paths opened =
      grown(grown(solid, -disk_radius * wall, ClipperLib::jtSquare), disk_radius * wall, ClipperLib::jtSquare);
  Paths result =
      operation(ClipperLib::ctIntersection, solid, grown(opened, corner_distance * wall, ClipperLib::jtSquare));
  trimmed_area = std::max(0.0, area_of(solid) - area_of(result));  // rounding may make it negative
  return result;
}

/// Makes the largest face that of the part, and adds the others to its crumbs.
void retain_largest(std::vector<SolidFace>& faces, Part& part) {
  const auto area_of_face = [](const SolidFace& face) {
    double sum = 0;
    for (const Polygon& polygon : face) sum += area(polygon);
    return sum;
  };
  std::size_t largest = 0;
  double max_area = 0, total = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double size = area_of_face(faces[i]);
    total += size;
    if (size > max_area) {
      max_area = size;
      largest = i;
    }
  }
  if (faces.empty()) return;
  part.crumbs += faces.size() - 1;
  part.crumb_area += total - max_area;
  part.solid_area = max_area;
  part.faces = {std::move(faces[largest])};
}

/// Indices of the solids of which less than half is in the part's face. But for trimming, it has all of a solid or
/// none.
std::vector<std::size_t> lost_solids(const PartDesign& design, const Paths& outline, const SolidFace& face) {
  std::vector<std::size_t> lost;
  const Paths piece = to_paths(face);
  for (std::size_t i = 0; i < design.solids.size(); ++i) {
    const Paths block = operation(ClipperLib::ctIntersection, to_paths({&design.solids[i], 1}), outline);
    if (area_of(operation(ClipperLib::ctIntersection, block, piece)) < area_of(block) / 2) lost.push_back(i);
  }
  return lost;
}

/// Widens the necks of the part's only face to the wall, or cuts them, and measures the narrowest place that is left.
void repair_necks(Part& part, const Paths& outline, double wall, double beam_width, double min_side) {
  if (wall <= 0) {
    part.smallest_neck = narrow_places(part.faces[0], 0, beam_width).narrowest_other;
    return;
  }
  NeckRepairs repairs(outline, wall);
  NarrowPlaces places = narrow_places(part.faces[0], repairs.limit(), beam_width);
  for (int k = 0; k < max_repairs; ++k) {
    const NeckRepair repair = repairs.next(part.faces[0], places.below);
    if (repair.is_empty()) {
      // The remaining narrow places belong to acute corners and stubs.
      places.below.clear();
      break;
    }
    Paths solid = to_paths(part.faces[0]);
    solid.insert(solid.end(), repair.added.begin(), repair.added.end());
    solid = operation(ClipperLib::ctDifference, operation(ClipperLib::ctUnion, solid, {}), repair.removed);
    if (has_touching_corners(solid)) solid = grown(solid, -corner_recess, ClipperLib::jtMiter);
    auto faces = faces_without_slivers(solid, min_side);
    retain_largest(faces, part);
    places = narrow_places(part.faces[0], repairs.limit(), beam_width);
  }
  part.widened_necks = repairs.widened();
  part.cut_necks = repairs.cut();
  part.left_necks = places.below.size();
  part.smallest_neck = places.narrowest_other;
  for (const NarrowPlace& place : places.below)
    part.smallest_neck = std::min(part.smallest_neck.value_or(place.width()), place.width());
}

}  // namespace

Part make_part_here(const PartDesign& design) {
  check(design);
  const PartAreas areas = areas_of(design);
  const Paths& outline = areas.outline;
  const Eigen::Vector2d centre = bounds_of_paths(outline).middle();
  Paths solid;
  double min_beam_width = design.filling.beam_width;
  for (std::size_t i = design.regions.size(); i-- > 0;) {
    const PartRegion& region = design.regions[i];
    const Paths beams = filled(region.filling, areas.regions[i], centre, design.rim);
    solid.insert(solid.end(), beams.begin(), beams.end());
    min_beam_width = std::min(min_beam_width, region.filling.beam_width);
    if (design.seam > 0) {
      const Paths shape = even_odd({region.outline});
      const Paths strip = operation(ClipperLib::ctDifference, grown(shape, design.seam / 2, ClipperLib::jtMiter),
                                    grown(shape, -design.seam / 2, ClipperLib::jtMiter));
      const Paths inside = operation(ClipperLib::ctIntersection, strip, outline);
      solid.insert(solid.end(), inside.begin(), inside.end());
    }
  }
  const Paths beams = filled(design.filling, areas.rest, centre, design.rim);
  solid.insert(solid.end(), beams.begin(), beams.end());
  if (design.frame > 0) {
    const Paths rim = operation(ClipperLib::ctDifference, outline, grown(outline, -design.frame, ClipperLib::jtMiter));
    solid.insert(solid.end(), rim.begin(), rim.end());
  }
  if (!design.solids.empty()) {
    const Paths blocks = operation(ClipperLib::ctIntersection, to_paths(design.solids), outline);
    solid.insert(solid.end(), blocks.begin(), blocks.end());
  }
  solid = operation(ClipperLib::ctUnion, solid, {});

  Part part;
  part.thickness = design.thickness;
  part.outline_area = area_of(outline);
  solid = trimmed(solid, design.smallest_wall, part.trimmed_area);
  if (design.smallest_wall > 0 && has_touching_corners(solid)) solid = joined_corners(solid, outline);
  if (has_touching_corners(solid)) solid = grown(solid, -corner_recess, ClipperLib::jtMiter);
  auto faces = faces_without_slivers(solid, min_part_side * min_beam_width);
  retain_largest(faces, part);
  if (part.faces.empty()) {
    throw PartError("tiling.part",
                    "Nothing of the structure lies within the outline: make it larger, or clip the tiles at it.",
                    {{"outline", "holds no part of the structure"}});
  }
  repair_necks(part, outline, design.smallest_wall, min_beam_width, min_part_side * min_beam_width);
  const Bounds extent = bounds_of(part.faces[0][0]);
  part.lower = extent.lower;
  part.upper = extent.upper;
  part.lost_solids = lost_solids(design, outline, part.faces[0]);
  if (design.divides_solid) part.regions = divided(part.faces[0], design, areas, min_part_side * min_beam_width);
  return part;
}

}  // namespace supple::tiling
