#include <charconv>
#include <cmath>

#include "helper_run.h"
#include "part_codec.h"
#include "part_tasks.h"
#include "polygon.h"
#include "solid_files.h"
#include "supple/base/error.h"
#include "supple/base/helper_processes.h"
#include "supple/tiling/part.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

constexpr std::string_view part_task = "tiling/part";
constexpr std::string_view caps_task = "tiling/caps";

/// Parts up to this area of the outline's bounding box, in squared beam widths, and this number of regions are made in
/// this process, because their union is so fast that a stop request may wait for it.
constexpr double max_area_in_process = 20'000;
constexpr std::size_t max_regions_in_process = 4;
/// Limit of the corners in a STEP file. A file of this size has 60 MB, for which CAD programs take minutes.
constexpr std::size_t max_step_corners = 50'000;

std::string two_decimals(double millimetres) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, std::round(100 * millimetres) / 100).ptr;
  return {text, end};
}

std::string title_of(const Part& part) { return "Supple part, " + size_words(part); }

/// The faces of the part, moved so that the centre of the bounding box is the origin.
std::vector<SolidFace> centred(const Part& part) {
  const Eigen::Vector2d centre = (part.lower + part.upper) / 2;
  auto faces = part.faces;
  for (auto& face : faces) {
    for (auto& polygon : face) polygon = moved(std::move(polygon), -centre);
  }
  return faces;
}

meshing::PlanarMesh caps(const std::vector<SolidFace>& faces, const Execution& execution) {
  execution.cancellation.throw_if_requested();
  const auto helpers = helper_processes();
  if (!helpers) return caps_of(faces);
  ByteWriter request;
  write(request, faces);
  const std::string answer = run_task(*helpers, caps_task, request.take(), execution);
  ByteReader reader(answer);
  return read_planar_mesh(reader);
}

}  // namespace

PartShape tensile_coupon(double width, double length, double grip_length) {
  const auto rectangle = [width](double from, double to) {
    return Polygon{{0, from}, {width, from}, {width, to}, {0, to}};
  };
  const double end = grip_length + length;
  PartShape shape{{rectangle(0, end + grip_length)}, {}};
  if (grip_length > 0) shape.solids = {rectangle(0, grip_length), rectangle(end, end + grip_length)};
  return shape;
}

double orientation_under_load(double orientation, double direction, double axis) {
  return orientation + axis - direction;
}

PartShape compression_block(double width, double height, double plate) { return tensile_coupon(width, height, plate); }

std::string size_words(const Part& part) {
  const Eigen::Vector2d size = part.upper - part.lower;
  return two_decimals(size.x()) + " x " + two_decimals(size.y()) + " x " + two_decimals(part.thickness) + " mm";
}

Part make_part(const PartDesign& design, const Execution& execution) {
  execution.cancellation.throw_if_requested();
  Bounds bounds = bounds_of(design.outline);
  for (const PartRegion& region : design.regions) {
    if (design.outline_of_regions) bounds.include(region.outline);
  }
  double min_beam_width = design.filling.beam_width;
  for (const PartRegion& region : design.regions) min_beam_width = std::min(min_beam_width, region.filling.beam_width);
  const auto helpers = helper_processes();
  const bool is_small = design.regions.size() <= max_regions_in_process &&
                        (bounds.upper - bounds.lower).prod() <= max_area_in_process * min_beam_width * min_beam_width;
  if (!helpers || is_small) return make_part_here(design);
  ByteWriter request;
  write(request, design);
  const std::string answer = run_task(*helpers, part_task, request.take(), execution);
  ByteReader reader(answer);
  return read_part(reader);
}

std::string part_svg(const Part& part) { return svg_of(centred(part), title_of(part)); }

std::string part_dxf(const Part& part) { return dxf_of(part.faces, title_of(part)); }

std::string part_stl(const Part& part, const Execution& execution) {
  return stl_of(part.faces, caps(part.faces, execution), part.thickness, title_of(part));
}

std::string part_3mf(const Part& part, const Execution& execution) {
  std::vector<NamedSolid> solids;
  const auto add = [&solids, &execution](const std::string& name, const std::vector<SolidFace>& faces) {
    solids.push_back({name, faces, caps(faces, execution)});
  };
  if (part.regions.empty()) add(title_of(part), part.faces);
  for (const RegionSolid& region : part.regions) add(region.name, region.faces);
  return three_mf_of(solids, part.thickness, title_of(part));
}

std::string part_step(const Part& part, const Execution& execution) {
  std::size_t corners = 0;
  for (const SolidFace& face : part.faces) {
    for (const Polygon& polygon : face) corners += polygon.size();
  }
  if (corners > max_step_corners) {
    const std::string numbers =
        std::to_string(corners) + " corners, and a STEP file has at most " + std::to_string(max_step_corners);
    throw PartError("tiling.part", "The part has " + numbers + ": widen the beams, or ask for STL or 3MF.",
                    {{"beam_width", "the part has " + numbers}});
  }
  return step_of(part.faces, part.thickness, title_of(part), execution);
}

void add_part_tasks(HelperTasks& tasks) {
  tasks.emplace(part_task, [](std::string_view request) {
    ByteReader reader(request);
    ByteWriter answer;
    write(answer, make_part_here(read_part_design(reader)));
    return answer.take();
  });
  tasks.emplace(caps_task, [](std::string_view request) {
    ByteReader reader(request);
    ByteWriter answer;
    write(answer, caps_of(read_faces(reader)));
    return answer.take();
  });
}

}  // namespace supple::tiling
