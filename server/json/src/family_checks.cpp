#include "supple/json/family_checks.h"

#include <Eigen/LU>
#include <algorithm>

#include "answer_parts.h"
#include "family_fields.h"
#include "request_parts.h"

namespace supple::json {
namespace {

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
