#include "supple/json/part_requests.h"

#include <algorithm>
#include <cmath>

#include "answer_parts.h"
#include "part_fields.h"
#include "request_parts.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double max_part_length = 2000;  // mm
constexpr double max_part_thickness = 1000;
constexpr std::size_t max_part_polygons = 100;
constexpr std::size_t max_part_corners = 5'000;
constexpr std::size_t max_part_regions = 50;
constexpr std::size_t max_region_name_bytes = 100;

/// Fraction of the solid in crumbs, which are left out, above which the answer's message tells it.
constexpr double min_reported_crumb_fraction = 0.05;

tiling::Polygon read_polygon(const Document& value, const std::string& pointer, Faults& faults) {
  tiling::Polygon polygon;
  if (!value.is_array() || value.size() < 3 || value.size() > max_part_corners) {
    faults.add(pointer, "must be an array of 3 to " + std::to_string(max_part_corners) + " points");
    return polygon;
  }
  polygon.resize(value.size());
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    read_components(value[i], pointer + "/" + std::to_string(i), faults, polygon[i], -max_part_length, max_part_length);
  }
  return polygon;
}

double length(Fields& fields, std::string_view name, double usual, bool may_vanish = false) {
  double value = usual;
  fields.number(name, value, 0, max_part_length, !may_vanish);
  return value;
}

/// The two solid ends of a coupon or a block, in the order of its solids.
std::vector<std::string> ends(const char* what) { return {std::string("lower_") + what, std::string("upper_") + what}; }

/// The shape of a part; empty if it is the union of its regions.
tiling::PartShape read_shape(Fields& fields, std::vector<std::string>& solid_names, bool& is_of_regions) {
  tiling::PartShape shape;
  const auto* value = fields.required("outline");
  if (!value) return shape;
  Fields outline(*value, fields.at("outline"), fields.faults());
  const int kinds = outline.present("rectangle") + outline.present("polygons") + outline.present("regions") +
                    outline.present("coupon") + outline.present("block");
  if (value->is_object() && kinds != 1) {
    fields.faults().add(fields.at("outline"),
                        R"(must have exactly one of "rectangle", "polygons", "regions", "coupon" and "block")");
  }
  if (const auto* regions = outline.optional("regions")) {
    is_of_regions = true;
    if (!regions->is_boolean() || !regions->get<bool>())
      fields.faults().add(outline.at("regions"), "must be true, or left out");
  }
  if (const auto* size = outline.optional("rectangle")) {
    Eigen::Vector2d sides(1, 1);
    read_components(*size, outline.at("rectangle"), fields.faults(), sides, 0.01, max_part_length);
    shape = tiling::tensile_coupon(sides[0], sides[1], 0);
  }
  if (const auto* polygons = outline.array("polygons", false, 1, max_part_polygons, "")) {
    for (std::size_t i = 0; i < polygons->size(); ++i) {
      shape.outline.push_back(
          read_polygon((*polygons)[i], outline.at("polygons") + "/" + std::to_string(i), fields.faults()));
    }
  }
  nested(outline, "coupon", [&](Fields& coupon) {
    coupon.required("width");
    coupon.required("length");
    const double width = length(coupon, "width", 1), gauge = length(coupon, "length", 1);
    shape = tiling::tensile_coupon(width, gauge, length(coupon, "grip_length", 15, true));
    solid_names = ends("grip");
  });
  nested(outline, "block", [&](Fields& block) {
    block.required("width");
    block.required("height");
    const double width = length(block, "width", 1), height = length(block, "height", 1);
    shape = tiling::compression_block(width, height, length(block, "plate", 1, true));
    solid_names = ends("plate");
  });
  outline.finish();
  return shape;
}

FillingSpec read_filling(Fields& fields, const Limits& limits) {
  FillingSpec filling;
  if (const auto* value = fields.required("structure")) {
    Fields structure(*value, fields.at("structure"), fields.faults());
    filling.structure = read_structure(structure, limits);
    structure.finish();
  }
  fields.number("beam_width", filling.beam_width, 0.01, max_beam_width);
  fields.number("orientation", filling.orientation, -1000, 1000);
  return filling;
}

/// Reads a direction of a design, which needs a part that has an axis of load.
void read_direction(Fields& fields, bool has_axis, std::optional<double>& direction) {
  if (!fields.present("direction")) return;
  fields.number("direction", direction.emplace(0), -1000, 1000);
  if (!has_axis) {
    fields.faults().add(fields.at("direction"),
                        R"(needs an axis of load: a "coupon" or a "block" as outline, or the part's "axis")");
  }
}

/// Reads the axis along which the part is loaded, and the direction of the design that is to lie along it.
void read_load(Fields& fields, PartRequest& request) {
  if (!request.solid_names.empty()) request.axis = tiling::load_axis;
  if (fields.present("axis")) {
    if (!request.solid_names.empty())
      fields.faults().add(fields.at("axis"), "is for other outlines: a coupon or a block is loaded along y");
    fields.number("axis", request.axis.emplace(0), -1000, 1000);
  }
  read_direction(fields, request.axis.has_value(), request.filling.direction);
}

PartRegionSpec read_region(Fields& fields, const PartRequest& request, const Limits& limits) {
  PartRegionSpec region;
  if (const auto* name = fields.optional("name")) {
    if (name->is_string() && name->get_ref<const std::string&>().size() <= max_region_name_bytes) {
      region.name = name->get<std::string>();
    } else {
      fields.faults().add(fields.at("name"),
                          "must be a string of at most " + std::to_string(max_region_name_bytes) + " bytes");
    }
  }
  if (const auto* outline = fields.required("outline"))
    region.outline = read_polygon(*outline, fields.at("outline"), fields.faults());
  region.filling = read_filling(fields, limits);
  region.filling.direction = request.filling.direction;
  read_direction(fields, request.axis.has_value(), region.filling.direction);
  return region;
}

}  // namespace

void read_part(Fields& fields, const Limits& limits, PartRequest& request) {
  auto shape = read_shape(fields, request.solid_names, request.design.outline_of_regions);
  request.design.outline = std::move(shape.outline);
  request.design.solids = std::move(shape.solids);
  request.filling = read_filling(fields, limits);
  read_load(fields, request);
  // Where the regions are the part, nothing has the structure of the rest.
  double finest = request.design.outline_of_regions ? max_beam_width : request.filling.beam_width;
  if (const auto* regions = fields.array("regions", false, 0, max_part_regions, "")) {
    for (std::size_t i = 0; i < regions->size(); ++i) {
      Fields region((*regions)[i], fields.at("regions") + "/" + std::to_string(i), fields.faults());
      request.regions.push_back(read_region(region, request, limits));
      region.finish();
      finest = std::min(finest, request.regions.back().filling.beam_width);
    }
  }
  if (request.design.outline_of_regions && request.regions.empty())
    fields.faults().add(fields.at("outline") + "/regions", "needs at least one region in \"regions\"");
  request.design.frame = length(fields, "frame", 0, true);
  request.design.seam = length(fields, "seam", request.regions.empty() ? 0 : finest, true);
  fields.choice("rim", request.design.rim, rim_names);
  request.design.smallest_wall = 2 * finest / 3;
  fields.number("smallest_wall", request.design.smallest_wall, 0, max_beam_width);
  fields.number("thickness", request.design.thickness, 1e-3, max_part_thickness);
}

void write_solid(JsonWriter& out, const tiling::Part& part) {
  const Eigen::Vector2d size = part.upper - part.lower;
  out.key("size").numbers(Eigen::Vector3d(size.x(), size.y(), part.thickness));
  out.key("lower").numbers(part.lower).key("upper").numbers(part.upper);
  out.field("outline_area", part.outline_area).field("solid_area", part.solid_area);
  out.field("relative_density", part.solid_area / part.outline_area);
}

void write_missing_solids(JsonWriter& out, const PartRequest& request, const tiling::Part& part) {
  out.key("missing_solids").begin_array();
  for (const std::size_t solid : part.lost_solids) out.string(request.solid_names.at(solid));
  out.end_array();
}

PartRequest parse_part(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<PartRequest>(body, limits, cancellation, [&](Fields& fields, PartRequest& request) {
    read_part(fields, limits, request);
    nested(fields, "material",
           [&](Fields& material) { material.number("density", request.material_density, 0, 25, true); });
    fields.boolean("svg", request.svg);
  });
}

double PartRequest::orientation_in_part(const FillingSpec& spec) const {
  if (!axis || !spec.direction) return spec.orientation;
  return tiling::orientation_under_load(spec.orientation, *spec.direction, *axis);
}

std::optional<double> PartRequest::tested_direction() const {
  return axis && filling.direction ? filling.direction : axis;
}

std::string part_message(const PartRequest& request, const tiling::Part& part) {
  constexpr const char* remedies =
      "Thinner walls, whose tiles are smaller, a greater width or a frame hold it together.";
  std::string missing;
  for (const std::size_t solid : part.lost_solids) {
    std::string name = request.solid_names.at(solid);
    std::replace(name.begin(), name.end(), '_', ' ');
    missing += missing.empty() ? "The " : " and the ";
    missing += name;
  }
  if (!missing.empty()) {
    return missing + (part.lost_solids.size() > 1 ? " are" : " is") +
           " missing: the structure does not reach from one end to the other in one piece. " + remedies;
  }
  if (part.left_necks > 0 && part.smallest_neck) {
    return "The part hangs by a neck of " + std::to_string(std::lround(1000 * *part.smallest_neck)) +
           " micrometres, narrower than the smallest wall, which could neither be widened nor cut. " + remedies;
  }
  const double crumb_fraction = part.crumb_area / (part.crumb_area + part.solid_area);
  if (crumb_fraction <= min_reported_crumb_fraction) return {};
  return "Pieces without connection to the largest one were left out, " +
         std::to_string(std::lround(100 * crumb_fraction)) + " % of the solid. " + remedies;
}

std::string write_part(const PartRequest& request, const tiling::Part& part, const std::string* svg, const Bill& bill) {
  const double volume = part.solid_area * part.thickness;
  JsonWriter out;
  out.begin_object();
  write_solid(out, part);
  out.field("volume", volume).field("mass", volume * request.material_density / 1000);
  out.field("holes", part.faces.at(0).size() - 1);
  out.field("orientation", request.orientation_in_part(request.filling));
  out.key("tested_direction");
  if (const auto direction = request.tested_direction())
    out.number(*direction);
  else
    out.null();
  out.key("checks")
      .begin_object()
      .field("pieces", part.faces.size())
      .field("smallest_wall", request.design.smallest_wall);
  out.key("smallest_neck");
  if (part.smallest_neck)
    out.number(*part.smallest_neck);
  else
    out.null();
  out.field("widened_necks", part.widened_necks).field("cut_necks", part.cut_necks);
  out.field("trimmed_area", part.trimmed_area).field("crumbs", part.crumbs).field("crumb_area", part.crumb_area);
  write_missing_solids(out, request, part);
  out.end_object().field("message", part_message(request, part));
  if (svg) out.field("svg", *svg);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
