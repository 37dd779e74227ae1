#include "supple/json/outline_requests.h"

#include "answer_parts.h"
#include "request_parts.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr std::size_t max_drawing_bytes = 10'000'000;
constexpr double min_chord_error = 1e-4;
constexpr double max_chord_error = 10;
constexpr double min_drawing_width = 0.01;
constexpr double max_drawing_width = 2000;
constexpr double min_resolution = 1;
constexpr double max_resolution = 10'000;

}  // namespace

OutlineRequest parse_outlines(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<OutlineRequest>(body, limits, cancellation, [&](Fields& fields, OutlineRequest& request) {
    if (const auto* text = fields.required("text")) {
      if (text->is_string() && text->get_ref<const std::string&>().size() <= max_drawing_bytes) {
        request.text = text->get<std::string>();
      } else {
        fields.faults().add("/text", "must be a string of at most " + std::to_string(max_drawing_bytes) + " bytes");
      }
    }
    fields.choice("format", request.options.format, drawing_format_names);
    fields.choice("unit", request.options.unit, length_unit_names);
    if (fields.present("resolution")) {
      double resolution = min_resolution;
      fields.number("resolution", resolution, min_resolution, max_resolution);
      request.options.resolution = resolution;
    }
    if (fields.present("width")) {
      double width = min_drawing_width;
      fields.number("width", width, min_drawing_width, max_drawing_width);
      request.options.width = width;
    }
    nested(fields, "accuracy", [&](Fields& accuracy) {
      accuracy.number("tolerance", request.options.tolerance, min_chord_error, max_chord_error);
    });
  });
}

std::string write_outlines(const OutlineRequest& request, const outlines::Drawing& drawing, const Bill& bill) {
  const Eigen::Vector2d size = drawing.upper - drawing.lower;
  JsonWriter out;
  out.begin_object().field("format", drawing_format_names.name_of(drawing.format)).key("polygons").begin_array();
  std::size_t corners = 0;
  for (const auto& outline : drawing.outlines) {
    corners += outline.corners.size();
    out.begin_object().key("names").begin_array();
    for (const auto& name : outline.names) out.string(name);
    out.end_array().key("points").begin_array();
    for (const auto& corner : outline.corners) out.numbers(corner);
    out.end_array().end_object();
  }
  out.end_array().key("size").numbers(size).key("lower").numbers(drawing.lower).key("upper").numbers(drawing.upper);
  out.field("unit", drawing.unit).field("unit_is_known", drawing.unit_is_known);
  out.field("curves", drawing.curves).field("joined_curves", drawing.joined);
  out.field("open_curves", drawing.open_curves).field("stroked_curves", drawing.stroked);
  out.field("united_shapes", drawing.united).field("clipped_shapes", drawing.clipped);
  out.field("simplified_corners", drawing.simplified).field("corners", corners);
  out.field("chord_error", drawing.chord_error);
  write_warnings(out, drawing.warnings);
  out.key("left_out").begin_array();
  for (const auto& one : drawing.left_out)
    out.begin_object().field("element", one.element).field("reason", one.reason).end_object();
  out.end_array().field("left_out_count", drawing.left_out_count);
  out.key("accuracy").begin_object().field("tolerance", request.options.tolerance).end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
