#include "supple/json/family_checks.h"

#include <Eigen/LU>
#include <algorithm>
#include <charconv>

#include "answer_parts.h"
#include "family_fields.h"
#include "request_parts.h"
#include "supple/tiling/isohedral_types.h"

namespace supple::json {
namespace {

constexpr std::size_t max_svg_bytes = 1'000'000;
constexpr std::size_t max_drawn_description_bytes = 500;

void write_drawing(JsonWriter& out, const DrawnTiling& drawn) {
  const tiling::Tiling& tiling = drawn.tiling;
  out.begin_object().key("parameters").numbers(drawn.parameters).field("beam_width", drawn.beam_width);
  out.key("lattice").begin_array();
  for (int k = 0; k < 2; ++k) out.numbers(tiling.lattice.col(k).eval());
  out.end_array().key("tiles").begin_array();
  for (const auto& placement : tiling.placements) {
    tiling::Polygon outline = tiling.tiles[static_cast<std::size_t>(placement.tile)];
    for (auto& vertex : outline) vertex = placement.linear * vertex + placement.offset;
    // A reflection reverses the order of the vertices.
    if (placement.linear.determinant() < 0) std::reverse(outline.begin(), outline.end());
    out.begin_array();
    for (const auto& vertex : outline) out.numbers(vertex);
    out.end_array();
  }
  out.end_array().end_object();
}

/// The number in the name of an isohedral type, such as "IH21"; 0 where it names none of them.
int type_of(std::string_view name) {
  if (name.size() != 4 || !name.starts_with("IH")) return 0;
  int number = 0;
  const auto [end, error] = std::from_chars(name.data() + 2, name.data() + name.size(), number);
  const bool is_number = error == std::errc() && end == name.data() + name.size();
  return is_number && tiling::find_isohedral_type(number) ? number : 0;
}

/// The ranges of api/openapi.yaml.
constexpr double min_reach = 0.001;
constexpr double max_reach = 0.5;
constexpr double max_drawn_beam_width = 1;

void read_drawn_tile(Fields& fields, FamilyUpload& upload) {
  auto& drawing = upload.drawing;
  const auto text = [&](std::string_view name, std::size_t max, std::string& out) {
    const auto* value = fields.optional(name);
    if (!value) return;
    if (!value->is_string() || value->get_ref<const std::string&>().size() > max)
      return fields.faults().add(fields.at(name), "must be a string of at most " + std::to_string(max) + " bytes");
    out = value->get<std::string>();
  };
  text("svg", max_svg_bytes, upload.svg);
  if (const auto* type = fields.required("type")) {
    if (type->is_string()) drawing.isohedral_type = type_of(type->get_ref<const std::string&>());
    if (drawing.isohedral_type == 0)
      fields.faults().add(fields.at("type"), "must be one of the 81 isohedral types, for example \"IH21\"");
  }
  read_family_id(fields, "id", drawing.id);
  text("description", max_drawn_description_bytes, drawing.description);
  fields.number("reach", drawing.reach, min_reach, max_reach);
  if (fields.present("beam_width"))
    fields.number("beam_width", drawing.beam_width.emplace(), 0, max_drawn_beam_width, true);
  fields.boolean("shape_parameters", drawing.has_shape_parameters);
}

}  // namespace

void write_findings(JsonWriter& out, std::string_view name, const std::vector<tiling::DefinitionFinding>& findings) {
  out.key(name).begin_array();
  for (const auto& finding : findings) {
    out.begin_object()
        .field("flaw", flaw_names.name_of(finding.flaw))
        .field("pointer", "/definition/" + finding.where)
        .field("message", finding.message)
        .key("parameters")
        .numbers(finding.parameters)
        .key("point");
    if (finding.point)
      out.numbers(*finding.point);
    else
      out.null();
    out.end_object();
  }
  out.end_array();
}

FamilyCheckRequest parse_family_check(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation) {
  return read_request<FamilyCheckRequest>(body, limits, cancellation, [&](Fields& fields, FamilyCheckRequest& request) {
    fields.required("definition");
    nested(fields, "definition", [&](Fields& definition) { request.definition = read_family_definition(definition); });
    if (fields.present("parameters")) {
      fields.numbers("parameters", request.parameters.emplace(), false, 0, limits.max_parameters);
    } else {
      fields.optional("parameters");
    }
  });
}

FamilyUpload parse_family_upload(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<FamilyUpload>(body, limits, cancellation, [&](Fields& fields, FamilyUpload& upload) {
    if (fields.present("definition") == fields.present("svg"))
      fields.faults().add(fields.at("definition"), "either \"definition\" or \"svg\" is required");
    if (fields.present("svg")) return read_drawn_tile(fields, upload);
    nested(fields, "definition", [&](Fields& definition) { upload.definition = read_family_definition(definition); });
  });
}

std::string write_added_family(const std::string& family, const std::vector<tiling::DefinitionFinding>& warnings) {
  JsonWriter out;
  out.begin_object().key("family").raw(family);
  write_findings(out, "warnings", warnings);
  out.end_object();
  return out.take();
}

std::string write_family_check(const tiling::DefinitionReport& report, const DrawnTiling* drawn, const Bill& bill) {
  JsonWriter out;
  out.begin_object().field("good", report.good());
  write_findings(out, "faults", report.faults);
  write_findings(out, "warnings", report.warnings);
  out.key("tiling");
  if (drawn)
    write_drawing(out, *drawn);
  else
    out.null();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
