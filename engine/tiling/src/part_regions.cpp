#include "part_regions.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "polygon.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

using ClipperLib::Paths;

/// Gaps between regions up to this width (mm) are closed: two drawings of one curve differ by the tolerance of their
/// chords, which is 0.05 mm on either side.
constexpr double max_gap = 0.1;
/// Distance (mm) by which closed gaps overlap the regions beside them, and within which regions touch. It is above the
/// rounding of coordinates and below all that can be made.
constexpr double overlap = 1e-6;
/// Limit of the regions that a message names one by one.
constexpr std::size_t max_named_regions = 20;

std::vector<Face> faces_in(const Paths& paths) {
  ClipperLib::Clipper clipper;
  clipper.AddPaths(paths, ClipperLib::ptSubject, true);
  ClipperLib::PolyTree tree;
  clipper.Execute(ClipperLib::ctUnion, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
  std::vector<Face> faces;
  add_faces(tree, faces);
  return faces;
}

bool meet(const Paths& a, const Paths& b) { return !operation(ClipperLib::ctIntersection, a, b).empty(); }

std::string name_of(const PartRegion& region, std::size_t i) {
  return region.name.empty() ? "Region " + std::to_string(i + 1) : region.name;
}

/// The area without gaps and notches up to twice `distance` (mm) wide. Otherwise it stays the same, but for rounding.
Paths closed(const Paths& area, double distance) {
  return grown(grown(area, distance, ClipperLib::jtMiter), -distance, ClipperLib::jtMiter);
}

/// The narrow gaps between two regions or more, each a little larger than it is. Narrow notches of one region are none.
Paths gaps_between(const std::vector<Paths>& shapes, const Paths& united) {
  std::vector<Bounds> bounds;
  for (const Paths& shape : shapes) {
    bounds.emplace_back();
    for (const auto& path : shape) bounds.back().include(to_polygon(path));
  }
  Paths gaps;
  // What lies within the overlap of the union is rounding.
  const Paths candidates =
      operation(ClipperLib::ctDifference, closed(united, max_gap / 2), grown(united, overlap, ClipperLib::jtMiter));
  for (const Face& face : faces_in(candidates)) {
    const Paths gap = grown(to_paths(face), 2 * overlap, ClipperLib::jtMiter);
    const Bounds around = bounds_of(face[0]);
    int touched = 0;
    for (std::size_t i = 0; i < shapes.size() && touched < 2; ++i)
      touched += around.meet(bounds[i], max_gap) && meet(gap, shapes[i]) ? 1 : 0;
    if (touched > 1) gaps.insert(gaps.end(), gap.begin(), gap.end());
  }
  return gaps;
}

/// Throws an error that names the pieces of the regions' union, of which there are several.
[[noreturn]] void refuse_pieces(const std::vector<PartRegion>& regions, const std::vector<Paths>& shapes,
                                const std::vector<Face>& faces) {
  std::size_t largest = 0, named = 0;
  std::vector<Paths> pieces;
  for (const Face& face : faces) {
    pieces.push_back(to_paths(face));
    if (area_of(pieces.back()) > area_of(pieces[largest])) largest = pieces.size() - 1;
  }
  std::string words;
  std::vector<Error::Detail> apart;
  for (std::size_t k = 0; k < pieces.size() && named < max_named_regions; ++k) {
    words += k == 0 ? "" : "; ";
    const char* before = "";
    for (std::size_t i = 0; i < regions.size() && named < max_named_regions; ++i) {
      if (!meet(pieces[k], shapes[i])) continue;
      words += before + name_of(regions[i], i);
      before = ", ";
      ++named;
      if (k != largest)
        apart.push_back({"regions/" + std::to_string(i) + "/outline", "lies apart from the largest piece"});
    }
  }
  if (named == max_named_regions) words += ", ...";
  throw PartError("tiling.part",
                  "The regions make " + std::to_string(faces.size()) + " pieces instead of one: " + words +
                      ". Let them touch, or give the part an outline around them.",
                  apart);
}

/// The union of the regions, in one piece.
Paths united_regions(const std::vector<PartRegion>& regions, const std::vector<Paths>& shapes) {
  Paths all;
  for (const Paths& shape : shapes) all.insert(all.end(), shape.begin(), shape.end());
  all = closed(operation(ClipperLib::ctUnion, all, {}), overlap);
  if (const Paths gaps = gaps_between(shapes, all); !gaps.empty()) all = operation(ClipperLib::ctUnion, all, gaps);
  const std::vector<Face> faces = faces_in(all);
  if (faces.size() > 1) refuse_pieces(regions, shapes, faces);
  return all;
}

/// Distributes the closed gaps among the regions beside them, so that nothing is outside the regions.
void fill_gaps(PartAreas& areas) {
  for (Paths& region : areas.regions) {
    if (areas.rest.empty()) return;
    const Paths own = operation(ClipperLib::ctIntersection, areas.rest, grown(region, max_gap, ClipperLib::jtMiter));
    if (own.empty()) continue;
    areas.rest = operation(ClipperLib::ctDifference, areas.rest, own);
    region = operation(ClipperLib::ctUnion, region, grown(own, overlap, ClipperLib::jtMiter));
  }
  areas.rest.clear();
}

}  // namespace

PartAreas areas_of(const PartDesign& design) {
  std::vector<Paths> shapes;
  for (const PartRegion& region : design.regions) shapes.push_back(even_odd({region.outline}));
  PartAreas areas;
  areas.outline = design.outline_of_regions ? united_regions(design.regions, shapes) : even_odd(design.outline);
  areas.rest = areas.outline;
  areas.regions.resize(shapes.size());
  for (std::size_t i = shapes.size(); i-- > 0;) {
    areas.regions[i] = operation(ClipperLib::ctIntersection, areas.rest, shapes[i]);
    areas.rest = operation(ClipperLib::ctDifference, areas.rest, shapes[i]);
  }
  if (design.outline_of_regions) fill_gaps(areas);
  return areas;
}

Paths even_odd(const std::vector<Polygon>& polygons) {
  Paths result;
  ClipperLib::SimplifyPolygons(to_paths(polygons), result, ClipperLib::pftEvenOdd);
  return result;
}

double area_of(const Paths& paths) {
  double sum = 0;
  for (const auto& path : paths) sum += ClipperLib::Area(path);
  return sum / (units_per_millimetre * units_per_millimetre);
}

bool has_touching_corners(const Paths& paths) {
  std::vector<std::pair<ClipperLib::cInt, ClipperLib::cInt>> corners;
  for (const auto& path : paths) {
    for (const auto& p : path) corners.emplace_back(p.X, p.Y);
  }
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

std::vector<RegionSolid> divided(const SolidFace& solid, const PartDesign& design, const PartAreas& areas,
                                 double min_width) {
  std::vector<RegionSolid> result;
  if (design.regions.empty()) return result;
  Paths remaining = to_paths(solid);
  const auto add = [&result, min_width](std::string name, Paths own) {
    if (has_touching_corners(own)) own = grown(own, -corner_recess, ClipperLib::jtMiter);
    auto faces = faces_without_slivers(own, min_width);
    if (!faces.empty()) result.push_back({std::move(name), std::move(faces)});
  };
  for (std::size_t i = 0; i < design.regions.size(); ++i) {
    add(name_of(design.regions[i], i), operation(ClipperLib::ctIntersection, remaining, areas.regions[i]));
    remaining = operation(ClipperLib::ctDifference, remaining, areas.regions[i]);
  }
  add("Rest", std::move(remaining));
  return result;
}

}  // namespace supple::tiling
