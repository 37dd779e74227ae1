#include "supple/json/measured_curve_requests.h"

#include "document.h"
#include "request_parts.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr std::size_t most_measured_points = 1'000'000;
constexpr std::size_t longest_column_name = 200;
constexpr std::size_t longest_unit = 40;
constexpr int most_table_columns = 256;
constexpr double largest_specimen_length = 1e6;

std::optional<std::string> read_text(Fields& fields, std::string_view name, std::size_t longest) {
  const auto* value = fields.optional(name);
  if (!value) return std::nullopt;
  if (!value->is_string() || value->get_ref<const std::string&>().size() > longest) {
    fields.faults().add(fields.at(name), "must be a string of at most " + std::to_string(longest) + " bytes");
    return std::nullopt;
  }
  return value->get<std::string>();
}

void read_column(Fields& fields, std::string_view name, design::ColumnChoice& out) {
  const auto* value = fields.optional(name);
  if (!value) return;
  if (value->is_number_integer() && value->get<double>() >= 0 && value->get<double>() < most_table_columns) {
    out = value->get<int>();
  } else if (value->is_string() && value->get_ref<const std::string&>().size() <= longest_column_name) {
    out = value->get<std::string>();
  } else {
    fields.faults().add(fields.at(name), "must be a column's index, an integer from 0 to " +
                                             std::to_string(most_table_columns - 1) + ", or its name in the header");
  }
}

void read_points(Fields& fields, std::vector<Eigen::Vector2d>& out) {
  const auto* points = fields.array("points", false, 2, most_measured_points, "");
  if (!points) return;
  out.resize(points->size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    read_components((*points)[i], fields.at("points") + "/" + std::to_string(i), fields.faults(), out[i], -any, any);
  }
}

void read_length(Fields& fields, std::string_view name, std::optional<double>& out) {
  double value = 0;
  fields.number(name, value, 0, largest_specimen_length, true);
  if (value > 0) out = value;
}

void read_range(Fields& fields, design::ReductionOptions& options) {
  const auto* value = fields.optional("range");
  if (!value) return;
  Eigen::Vector2d range = Eigen::Vector2d::Zero();
  if (!read_components(*value, fields.at("range"), fields.faults(), range, -1e6, 1e6)) return;
  if (!(range[0] < range[1]))
    return fields.faults().add(fields.at("range"), "must have its first number below its second");
  options.lower = range[0];
  options.upper = range[1];
}

}  // namespace

MeasuredCurveRequest parse_measured_curve(std::string_view body, const Limits& limits) {
  const auto owned = parse_document(body, limits);
  const Document& document = owned;
  MeasuredCurveRequest request;
  Faults faults;
  Fields fields(document, "", faults);
  fields.choice("task", request.task, {"stress_strain", "stiffness", "poisson"});
  request.text = read_text(fields, "text", body.size());
  read_points(fields, request.points);
  if (document.is_object() && fields.present("text") == fields.present("points")) {
    faults.add("", "must have exactly one of \"text\" and \"points\"");
  }
  nested(fields, "columns", [&](Fields& columns) {
    if (fields.present("points"))
      faults.add(fields.at("columns"), "must not stand beside \"points\", which have x and y");
    read_column(columns, "x", request.x);
    read_column(columns, "y", request.y);
  });
  nested(fields, "units", [&](Fields& units) {
    request.x_unit = read_text(units, "x", longest_unit);
    request.y_unit = read_text(units, "y", longest_unit);
  });
  nested(fields, "specimen", [&](Fields& specimen) {
    read_length(specimen, "gauge_length", request.specimen.gauge_length);
    read_length(specimen, "area", request.specimen.area);
  });
  read_range(fields, request.options);
  fields.choice("interpolation", request.options.interpolation, {"cubic", "monotone", "linear"});
  nested(fields, "accuracy", [&](Fields& accuracy) {
    accuracy.number("tolerance", request.options.tolerance, 1e-9, 1);
    accuracy.integer("max_control_points", request.options.max_control_points, 2, 64);
  });
  nested(fields, "effects", [&](Fields& effects) {
    effects.choice("origin", request.options.origin, switch_names);
    effects.choice("loading", request.options.loading, switch_names);
  });
  request.deadline = read_deadline(fields, limits);
  fields.finish();
  faults.throw_if_any();
  return request;
}

}  // namespace supple::json
