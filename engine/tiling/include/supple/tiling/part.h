#pragma once

#include <Eigen/Core>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/tiling/structure.h"

namespace supple::tiling {

/// A connected region of the plane: its counterclockwise outline, then its clockwise holes.
using SolidFace = std::vector<Polygon>;

/// What fills an area: a structure, scaled and rotated.
struct Filling {
  Structure structure;
  double beam_width = printed_beam_width;  ///< mm; the structure is scaled to it
  double orientation = 0;                  ///< rad, counterclockwise
};

/// A part of the outline with a filling of its own.
struct PartRegion {
  Polygon outline;  ///< mm; a simple polygon of either direction
  Filling filling;
  std::string name{};  ///< may be empty
};

/// What happens to tiles at the outline.
enum class Rim {
  clipped,  ///< beams are cut off at the outline
  whole     ///< the part has only tiles that lie within the outline, whose beams are whole
};

/// A flat part to be cut or printed: an outline that structures fill. Lengths in millimetres.
struct PartDesign {
  std::vector<Polygon> outline;  ///< simple polygons; the part lies within an odd number of them
  bool outline_of_regions =
      false;        ///< the part is the union of the regions; `outline` is empty, and nothing is the rest
  Filling filling;  ///< filling outside the regions
  std::vector<PartRegion> regions;  ///< later ones lie over earlier ones
  std::vector<Polygon> solids;      ///< areas that are solid, such as grips and plates
  double frame = 0;                 ///< width of a solid rim along the outline
  double seam = 0;                  ///< width of a solid strip along the outlines of regions, half on either side
  Rim rim = Rim::clipped;
  /// Walls and tips narrower than this are left out, and necks are widened to it. 0 does neither. Beams that are not
  /// scaled are 0.3 mm wide.
  double smallest_wall = 0.2;
  double thickness = 1;  ///< thickness of the extrusion
  /// Whether the solid is divided among the regions, too (`Part::regions`). Only 3MF needs it. It changes nothing else.
  bool divides_solid = false;
};

/// An outline and its solid areas.
struct PartShape {
  std::vector<Polygon> outline, solids;
};

/// The direction of y, along which coupons and blocks are loaded: its angle from x, rad. Other outlines may have any.
inline constexpr double load_axis = std::numbers::pi / 2;

/// A strip for a tensile test: `length` of the structure along y between solid grips of `grip_length` (mm).
PartShape tensile_coupon(double width, double length, double grip_length);
/// A block for a compression test: `height` of the structure along y between solid plates of the thickness `plate`
/// (mm).
PartShape compression_block(double width, double height, double plate);

/// The orientation (rad) that a structure must have in a part, which is loaded along `axis` (rad), so that it is loaded
/// as in a design: there it has the orientation `orientation` (rad) and is loaded along `direction` (rad).
double orientation_under_load(double orientation, double direction, double axis = load_axis);

/// The solid within one region, or outside all of them.
struct RegionSolid {
  std::string name;              ///< that of the region, or "Region 2" by its number from 1; "Rest" outside all regions
  std::vector<SolidFace> faces;  ///< its connected pieces
};

/// The solid of a part.
struct Part {
  std::vector<SolidFace> faces;  ///< one face, since the solid is connected; none if nothing remains
  /// The same solid, divided among the regions in their order and the rest, which is last; those without solid are left
  /// out. Empty if the design has no regions, or does not ask for it.
  std::vector<RegionSolid> regions;
  Eigen::Vector2d lower, upper;  ///< the solid's bounding box, mm
  double outline_area = 0;       ///< area within the outline, mm^2
  double solid_area = 0;         ///< mm^2
  double trimmed_area = 0;       ///< area of walls and tips that were too narrow, mm^2
  std::size_t crumbs = 0;        ///< pieces without connection to the largest one, which are left out
  double crumb_area = 0;         ///< mm^2
  // Necks are places narrower than the smallest wall between wider ones: eroding the solid by half the wall separates
  // it there.
  std::size_t widened_necks = 0;  ///< necks that were widened to the wall
  std::size_t cut_necks = 0;      ///< necks that were cut, because they could not be widened within the outline
  std::size_t left_necks = 0;     ///< necks that are left, because repairing them only made others
  /// The width in mm of the narrowest place between wider ones, measured on the faces; none if there is none. It is at
  /// least 0.98 smallest walls if no necks are left.
  std::optional<double> smallest_neck;
  /// Indices of the design's solids that are not in the part, because they are not connected to it.
  std::vector<std::size_t> lost_solids;
  double thickness = 0;  ///< mm
};

/// Fills the outline. If it is the union of the regions, gaps between them up to 0.1 mm wide are closed. A lattice
/// point of every filling lies in the middle of the outline's bounding box. Walls and tips narrower than the smallest
/// wall are left out, and necks are widened to it or cut. Corners that touch are joined, and are necks then. If they
/// cannot be joined, they are separated by some micrometres, so that the solid is a manifold.
///
/// Throws "tiling.part" if an outline is empty, crosses itself or is larger than 2000 mm, a length is out of range, the
/// smallest wall is wider than the beams, the outlines have more than 5,000 corners, or more than 50,000 tiles would
/// fill a region (each with its place: "outline/0", "regions/2/outline"); also if no tile lies within the outline and
/// `rim` is whole, and if the union of the regions is not one piece (with the places of those apart from the largest).
/// If there is a helper process and there are many tiles, the helper makes the union of the beams. O(n log n) for n
/// sides of all tiles: some 5 ms for 40 holes, 0.5 s for 2,300.
Part make_part(const PartDesign& design, const Execution& execution = {});

// The part as files, lengths in millimetres; their titles give the size. STL and 3MF are closed, consistently oriented
// surfaces. A 3MF package has one object for each of the part's regions, if there are any, which bear their names and
// are the components of one object. If there is a helper process, it makes their triangles, and what `HelperProcesses`
// throws is thrown.

std::string part_svg(const Part& part);
std::string part_dxf(const Part& part);
std::string part_stl(const Part& part, const Execution& execution = {});
std::string part_3mf(const Part& part, const Execution& execution = {});
/// A solid with plane faces (ISO 10303-21, AP214) for CAD programs. It is written in this process; a stop request ends
/// this within a millisecond. Throws "tiling.part" (place "beam_width") if the part has more than 50,000 corners. O(n):
/// 2 ms and 1.2 MB for 1,000 corners.
std::string part_step(const Part& part, const Execution& execution = {});

/// The size of the part as text, "40 x 120 x 2 mm", for titles and file names.
std::string size_words(const Part& part);

}  // namespace supple::tiling
