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

/// What fills an area: a structure of any size, turned.
struct Filling {
  Structure structure;
  double beam_width = printed_beam_width;  ///< mm; the structure is scaled to it
  double orientation = 0;                  ///< rad, counterclockwise
};

/// A part of the outline with a filling of its own.
struct PartRegion {
  Polygon outline;  ///< mm; a simple polygon of either direction
  Filling filling;
};

/// What happens to tiles at the outline.
enum class Rim {
  clipped,  ///< beams are cut off where the outline runs
  whole     ///< only tiles that lie within it, whose beams are whole
};

/// A flat part to be cut or printed: an outline that structures fill. Lengths in millimetres.
struct PartDesign {
  std::vector<Polygon> outline;     ///< simple polygons; what lies within an odd number of them belongs to the part
  Filling filling;                  ///< of what lies in no region
  std::vector<PartRegion> regions;  ///< later ones lie over earlier ones
  std::vector<Polygon> solids;      ///< parts of the outline that are solid: grips, plates
  double frame = 0;                 ///< width of a solid rim along the outline
  double seam = 0;                  ///< width of a solid strip along the outlines of regions, half on either side
  Rim rim = Rim::clipped;
  /// Walls and tips narrower than this are left out, and necks are widened to it; beams are 0.3 mm wide where nothing
  /// scales them. 0 does neither.
  double smallest_wall = 0.2;
  double thickness = 1;  ///< of the extrusion
};

/// An outline and what is solid of it.
struct PartShape {
  std::vector<Polygon> outline, solids;
};

/// The angle of y, along which coupons and blocks are loaded, from x in rad.
inline constexpr double load_axis = std::numbers::pi / 2;

/// A strip for a tensile test: `length` of the structure along y between solid grips of `grip_length` (mm).
PartShape tensile_coupon(double width, double length, double grip_length);
/// A block for a compression test: `height` of the structure along y between solid plates of the thickness `plate`
/// (mm).
PartShape compression_block(double width, double height, double plate);

/// The orientation of a structure (rad) in a coupon or a block whose load, along y, is to be the load of a design along
/// `direction` (rad): the design with its structure, which lies in it as `orientation` says, is turned until the
/// direction points along y.
double orientation_under_load(double orientation, double direction);

/// The solid of a part.
struct Part {
  std::vector<SolidFace> faces;  ///< connected, so that there is one, or none where nothing remains
  Eigen::Vector2d lower, upper;  ///< the solid's bounding box, mm
  double outline_area = 0;       ///< mm^2 within the outline
  double solid_area = 0;         ///< mm^2
  double trimmed_area = 0;       ///< mm^2 of walls and tips that were too narrow
  std::size_t crumbs = 0;        ///< pieces without connection to the largest one, which are left out
  double crumb_area = 0;         ///< mm^2
  /// Necks: places narrower than the smallest wall between wider ones, where eroding the solid by half the wall parts
  /// it.
  std::size_t widened_necks = 0;  ///< those that were widened to the wall
  std::size_t cut_necks = 0;      ///< those that were cut, because they could not be widened within the outline
  std::size_t left_necks = 0;     ///< those that are left where repairing them only made others
  /// The width in mm of the narrowest place between wider ones, measured on the faces; none if there is none. It is at
  /// least 0.98 smallest walls if no necks are left.
  std::optional<double> smallest_neck;
  /// Indices of the design's solids that are not in the part: what fills the outline does not hold on to them.
  std::vector<std::size_t> lost_solids;
  double thickness = 0;  ///< mm
};

/// Fills the outline. A lattice point of every filling lies in the middle of the outline's bounding box. Walls and tips
/// narrower than the smallest wall are left out, and necks are widened to it or cut. Corners that touch are joined and
/// are necks then; where they cannot be, they are parted by some micrometres, so that the solid is a manifold. Throws
/// "tiling.part" where an outline is empty, crosses itself or is larger than 2000 mm, a length is out of range, the
/// smallest wall is wider than the beams, the outlines have more than 5,000 corners, or more than 50,000 tiles would
/// fill a region (each with its place: "outline/0", "regions/2/outline"); with `rim` whole also where no tile lies
/// within. The union of the beams is made by a helper process where there is one and there are many tiles. O(n log n)
/// for n sides of all tiles: some 5 ms for 40 holes, 0.5 s for 2,300.
Part make_part(const PartDesign& design, const Execution& execution = {});

// The part as files, lengths in millimetres; their titles give the size. STL and 3MF are closed, consistently oriented
// surfaces; triangles are made by a helper process where there is one, and what `HelperProcesses` throws is thrown.

std::string part_svg(const Part& part);
std::string part_dxf(const Part& part);
std::string part_stl(const Part& part, const Execution& execution = {});
std::string part_3mf(const Part& part, const Execution& execution = {});
/// A solid with plane faces (ISO 10303-21, AP214) for CAD programs, written in this process; a stop is followed within
/// a millisecond. Throws "tiling.part" (place "beam_width") where the part has more than 50,000 corners. O(n): 2 ms and
/// 1.2 MB for 1,000 corners.
std::string part_step(const Part& part, const Execution& execution = {});

/// "40 x 120 x 2 mm": what titles say and file names are made of.
std::string size_words(const Part& part);

}  // namespace supple::tiling
