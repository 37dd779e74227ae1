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
#include "part_tasks.h"
#include "polygon.h"
#include "supple/base/faults.h"

namespace supple::tiling {
namespace {

using ClipperLib::Paths;

constexpr double largest_size = 2000;  // mm
constexpr double largest_thickness = 1000;
constexpr std::size_t most_tiles = 50'000;
/// Whether outlines cross themselves is looked at side by side.
constexpr std::size_t most_corners = 5'000;
/// Sides that are shorter (beam widths) are points, as in other files.
constexpr double smallest_part_side = 0.005;
/// Repairing a neck may leave others beside it; so many times they are looked for.
constexpr int max_neck_repairs = 8;
/// How far corners that touch are parted on either side, mm: less than any printer or laser sees.
constexpr double parting = 2e-3;
/// Walls are narrow where no disk of this share of the smallest wall fits in.
constexpr double disk = 0.49;
/// What lies so near (smallest walls) to where a disk fits is no narrow wall but a corner.
constexpr double corner = 0.25;

void check_polygon(const Polygon& polygon, const std::string& place, Faults& faults) {
  if (polygon.size() < 3) return faults.add(place, "must have at least 3 corners");
  for (const auto& p : polygon) {
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > largest_size)
      return faults.add(place, "must have coordinates from -2000 to 2000 mm");
  }
  if (const auto crossing = self_intersection(polygon)) {
    faults.add(place, "crosses or touches itself: its sides " + std::to_string(crossing->first) + " and " +
                          std::to_string(crossing->second) + " meet");
  }
}

void check_length(double value, double least, double most, const std::string& place, Faults& faults) {
  faults.require(
      value >= least && value <= most, place,
      "must be from " + std::to_string(least) + " to " + std::to_string(most) + " mm, got " + std::to_string(value));
}

void check_filling(const Filling& filling, const PartDesign& design, const std::string& folder, Faults& faults) {
  check_length(filling.beam_width, 0.01, 100, folder + "beam_width", faults);
  faults.require(design.smallest_wall <= filling.beam_width, "smallest_wall",
                 "must be at most the width of the beams, " + std::to_string(filling.beam_width) + " mm, got " +
                     std::to_string(design.smallest_wall));
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
  faults.require(corners <= most_corners, "outline",
                 "must have at most " + std::to_string(most_corners) + " corners together with all regions, got " +
                     std::to_string(corners));
  faults.throw_if_any("tiling.part", "The part");
  faults.require(!design.outline.empty(), "outline", "must have at least one polygon");
  for (std::size_t i = 0; i < design.outline.size(); ++i)
    check_polygon(design.outline[i], "outline/" + std::to_string(i), faults);
  for (std::size_t i = 0; i < design.solids.size(); ++i)
    check_polygon(design.solids[i], "solids/" + std::to_string(i), faults);
  check_length(design.frame, 0, largest_size, "frame", faults);
  check_length(design.seam, 0, largest_size, "seam", faults);
  check_length(design.smallest_wall, 0, 100, "smallest_wall", faults);
  check_length(design.thickness, 1e-3, largest_thickness, "thickness", faults);
  check_filling(design.filling, design, "", faults);
  for (std::size_t i = 0; i < design.regions.size(); ++i) {
    const std::string folder = "regions/" + std::to_string(i) + "/";
    check_polygon(design.regions[i].outline, folder + "outline", faults);
    check_filling(design.regions[i].filling, design, folder, faults);
  }
  faults.throw_if_any("tiling.part", "The part");
}

double area_of(const Paths& paths) {
  double sum = 0;
  for (const auto& path : paths) sum += ClipperLib::Area(path);
  return sum / (units_per_millimetre * units_per_millimetre);
}

/// Polygons that overlap in any way as an area: what lies within an odd number of them.
Paths even_odd(const std::vector<Polygon>& polygons) {
  Paths result;
  ClipperLib::SimplifyPolygons(to_paths(polygons), result, ClipperLib::pftEvenOdd);
  return result;
}

/// The tiles of a filling whose beams may reach into a box, turned and scaled.
std::vector<Polygon> tiles_over(const Filling& filling, const Bounds& box, const Eigen::Vector2d& centre) {
  const double scale = filling.beam_width / filling.structure.beam_width;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(filling.orientation).toRotationMatrix() * scale;
  const Tiling& tiling = filling.structure.tiling;
  const Eigen::Matrix2d lattice = turn * tiling.lattice;
  std::vector<Polygon> cell;
  Bounds reach;
  for (const Placement& placement : tiling.placements) {
    cell.push_back(placed(tiling.tiles[static_cast<std::size_t>(placement.tile)], placement));
    for (auto& p : cell.back()) p = turn * p;
    reach.include(cell.back());
  }
  // Cells (a, b) whose tiles may meet the box: the box, less the reach of a cell, in lattice coordinates.
  const Eigen::Matrix2d inverse = lattice.inverse();
  Eigen::Vector2d least = Eigen::Vector2d::Constant(INFINITY), most = -least;
  for (int corner_index = 0; corner_index < 4; ++corner_index) {
    const bool right = corner_index % 2 == 1, top = corner_index / 2 == 1;
    const Eigen::Vector2d p(right ? box.upper.x() - reach.lower.x() : box.lower.x() - reach.upper.x(),
                            top ? box.upper.y() - reach.lower.y() : box.lower.y() - reach.upper.y());
    const Eigen::Vector2d at = inverse * (p - centre);
    least = least.cwiseMin(at);
    most = most.cwiseMax(at);
  }
  const Eigen::Vector2d first = least.array().floor(), last = most.array().ceil();
  const Eigen::Vector2d counts = last - first + Eigen::Vector2d::Ones();
  // Of a lattice that lies across the box half of these cells or fewer meet it.
  if (!(counts.prod() * static_cast<double>(cell.size()) <= 20.0 * most_tiles)) {
    throw Error("tiling.part", "The part would have more than 50000 tiles: widen the beams or make it smaller.",
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
        if (tiles.size() > most_tiles) {
          throw Error("tiling.part", "The part would have more than 50000 tiles: widen the beams or make it smaller.",
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

/// The tiles that lie within an area, with half a beam's width to spare.
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

/// Leaves out what is narrower than the wall.
Paths trimmed(const Paths& solid, double wall, double& trimmed_area) {
  if (wall <= 0) return solid;
  const Paths opened = grown(grown(solid, -disk * wall, ClipperLib::jtSquare), disk * wall, ClipperLib::jtSquare);
  Paths result = operation(ClipperLib::ctIntersection, solid, grown(opened, corner * wall, ClipperLib::jtSquare));
  trimmed_area = std::max(0.0, area_of(solid) - area_of(result));  // but for rounding
  return result;
}

/// Whether two corners of the solid lie in one place.
bool has_touching_corners(const Paths& paths) {
  std::vector<std::pair<ClipperLib::cInt, ClipperLib::cInt>> corners;
  for (const auto& path : paths) {
    for (const auto& p : path) corners.emplace_back(p.X, p.Y);
  }
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

/// Keeps the largest face. The others are crumbs, besides those of before.
void keep_largest(std::vector<SolidFace>& faces, Part& part) {
  const auto area_of_face = [](const SolidFace& face) {
    double sum = 0;
    for (const Polygon& polygon : face) sum += area(polygon);
    return sum;
  };
  std::size_t largest = 0;
  double most = 0, total = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double size = area_of_face(faces[i]);
    total += size;
    if (size > most) {
      most = size;
      largest = i;
    }
  }
  if (faces.empty()) return;
  part.crumbs += faces.size() - 1;
  part.crumb_area += total - most;
  part.solid_area = most;
  part.faces = {std::move(faces[largest])};
}

/// Those of which the kept piece holds less than half. It holds all of a block or nothing, but for what was trimmed.
std::vector<std::size_t> lost_solids(const PartDesign& design, const Paths& outline, const SolidFace& kept) {
  std::vector<std::size_t> lost;
  const Paths piece = to_paths(kept);
  for (std::size_t i = 0; i < design.solids.size(); ++i) {
    const Paths block = operation(ClipperLib::ctIntersection, to_paths({&design.solids[i], 1}), outline);
    if (area_of(operation(ClipperLib::ctIntersection, block, piece)) < area_of(block) / 2) lost.push_back(i);
  }
  return lost;
}

/// Widens the necks of the part's only face to the wall, or cuts them, and measures the narrowest place that is left.
void repair_necks(Part& part, const Paths& outline, double wall, double beam_width, double shortest_side) {
  if (wall <= 0) {
    part.smallest_neck = narrow_places(part.faces[0], 0, beam_width).least_of_rest;
    return;
  }
  NeckRepairs repairs(outline, wall);
  NarrowPlaces places = narrow_places(part.faces[0], repairs.limit(), beam_width);
  for (int k = 0; k < max_neck_repairs; ++k) {
    const NeckRepair repair = repairs.next(part.faces[0], places.below);
    if (repair.is_empty()) {
      // What is narrower than the rest belongs to acute corners and stubs.
      places.below.clear();
      break;
    }
    Paths solid = to_paths(part.faces[0]);
    solid.insert(solid.end(), repair.added.begin(), repair.added.end());
    solid = operation(ClipperLib::ctDifference, operation(ClipperLib::ctUnion, solid, {}), repair.removed);
    if (has_touching_corners(solid)) solid = grown(solid, -parting, ClipperLib::jtMiter);
    auto faces = faces_without_slivers(solid, shortest_side);
    keep_largest(faces, part);
    places = narrow_places(part.faces[0], repairs.limit(), beam_width);
  }
  part.widened_necks = repairs.widened();
  part.cut_necks = repairs.cut();
  part.left_necks = places.below.size();
  part.smallest_neck = places.least_of_rest;
  for (const NarrowPlace& place : places.below)
    part.smallest_neck = std::min(part.smallest_neck.value_or(place.width()), place.width());
}

}  // namespace

Part make_part_here(const PartDesign& design) {
  check(design);
  const Paths outline = even_odd(design.outline);
  const Eigen::Vector2d centre = bounds_of_paths(outline).middle();
  // Each area is what later regions leave of it.
  Paths rest = outline, solid;
  double finest = design.filling.beam_width;
  for (auto region = design.regions.rbegin(); region != design.regions.rend(); ++region) {
    const Paths shape = even_odd({region->outline});
    const Paths own = operation(ClipperLib::ctIntersection, rest, shape);
    const Paths beams = filled(region->filling, own, centre, design.rim);
    solid.insert(solid.end(), beams.begin(), beams.end());
    rest = operation(ClipperLib::ctDifference, rest, shape);
    finest = std::min(finest, region->filling.beam_width);
    if (design.seam > 0) {
      const Paths strip = operation(ClipperLib::ctDifference, grown(shape, design.seam / 2, ClipperLib::jtMiter),
                                    grown(shape, -design.seam / 2, ClipperLib::jtMiter));
      const Paths inside = operation(ClipperLib::ctIntersection, strip, outline);
      solid.insert(solid.end(), inside.begin(), inside.end());
    }
  }
  const Paths beams = filled(design.filling, rest, centre, design.rim);
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
  if (has_touching_corners(solid)) solid = grown(solid, -parting, ClipperLib::jtMiter);
  auto faces = faces_without_slivers(solid, smallest_part_side * finest);
  keep_largest(faces, part);
  if (part.faces.empty()) {
    throw Error("tiling.part",
                "Nothing of the structure lies within the outline: make it larger, or clip the tiles at it.",
                {{"outline", "holds no part of the structure"}});
  }
  repair_necks(part, outline, design.smallest_wall, finest, smallest_part_side * finest);
  const Bounds extent = bounds_of(part.faces[0][0]);
  part.lower = extent.lower;
  part.upper = extent.upper;
  part.lost_solids = lost_solids(design, outline, part.faces[0]);
  return part;
}

}  // namespace supple::tiling
