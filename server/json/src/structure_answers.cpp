#include "supple/json/structure_answers.h"

#include <Eigen/LU>
#include <algorithm>

#include "answer_parts.h"
#include "supple/json/family_definitions.h"

namespace supple::json {
namespace {

void write_polygon(JsonWriter& out, tiling::Polygon polygon, const tiling::Placement& placement) {
  for (auto& corner : polygon) corner = placement.linear * corner + placement.offset;
  // A reflection reverses the order of the corners.
  if (placement.linear.determinant() < 0) std::reverse(polygon.begin(), polygon.end());
  out.begin_array();
  for (const auto& corner : polygon) out.numbers(corner);
  out.end_array();
}

template <class Value>
void write_bound(JsonWriter& out, std::string_view name, const std::vector<tiling::Parameter>& parameters,
                 Value tiling::Parameter::*value) {
  out.key(name).begin_array();
  for (const auto& parameter : parameters) out.number(parameter.*value);
  out.end_array();
}

void write_tiles(JsonWriter& out, const tiling::Structure& structure) {
  out.key("tiles").begin_array();
  for (std::size_t k = 0; k < structure.holes.size(); ++k) {
    const auto& placement = structure.tiling.placements[k];
    out.begin_object().key("outline");
    write_polygon(out, structure.tiling.tiles[static_cast<std::size_t>(placement.tile)], placement);
    out.key("holes").begin_array();
    for (const auto& hole : structure.holes[k]) write_polygon(out, hole, {});
    out.end_array().end_object();
  }
  out.end_array();
}

void write_mesh(JsonWriter& out, const MeshedCell& mesh) {
  out.key("mesh")
      .begin_object()
      .field("mesh_size", mesh.options.mesh_size)
      .field("corner_size", mesh.options.corner_size)
      .field("nodes", mesh.statistics.nodes)
      .field("triangles", mesh.statistics.triangles)
      .field("smallest_angle", mesh.statistics.smallest_angle)
      .field("shortest_side", mesh.statistics.shortest_side)
      .field("longest_side", mesh.statistics.longest_side)
      .field("relative_density", mesh.statistics.relative_density)
      .end_object();
}

}  // namespace

std::string write_families(const std::vector<std::string>& families) {
  JsonWriter out;
  out.begin_object().key("families").begin_array();
  for (const auto& family : families) out.raw(family);
  out.end_array().end_object();
  return out.take();
}

std::string write_family(const tiling::Family& family, const tiling::Structure& preset,
                         std::optional<std::int64_t> created) {
  JsonWriter out;
  out.begin_object().field("id", family.id).field("description", family.description);
  out.key("parameters").begin_object();
  write_bound(out, "lower", family.parameters, &tiling::Parameter::lower);
  write_bound(out, "upper", family.parameters, &tiling::Parameter::upper);
  write_bound(out, "default", family.parameters, &tiling::Parameter::preset);
  out.end_object();
  out.field("beam_width", family.beam_width)
      .field("printed_beam_width", preset.beam_width)
      .field("scale", preset.scale);
  out.key("cell").begin_object().field("tiles", preset.tiling.placements.size());
  write_lattice(out, preset.tiling.lattice);
  out.field("area", preset.cell_area).field("relative_density", preset.solid_area / preset.cell_area);
  out.end_object().key("created");
  if (created)
    out.string(time_text(*created));
  else
    out.null();
  out.key("definition");
  if (family.definition)
    write_family_definition(out, *family.definition);
  else
    out.null();
  out.end_object();
  return out.take();
}

std::string write_structure(const tiling::Structure& structure, const MeshedCell* mesh, const std::string* svg,
                            const Bill& bill) {
  JsonWriter out;
  out.begin_object().field("family", structure.family).key("parameters").numbers(structure.parameters);
  out.field("beam_width", structure.beam_width).field("scale", structure.scale);
  write_lattice(out, structure.tiling.lattice);
  write_tiles(out, structure);
  out.field("cell_area", structure.cell_area)
      .field("solid_area", structure.solid_area)
      .field("relative_density", structure.solid_area / structure.cell_area);
  if (mesh) write_mesh(out, *mesh);
  if (svg) out.field("svg", *svg);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
