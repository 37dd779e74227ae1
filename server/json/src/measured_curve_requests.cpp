#include "supple/json/measured_curve_requests.h"

#include <algorithm>
#include <array>

#include "request_parts.h"
#include "supple/design/measured_text.h"
#include "supple/json/design_requests.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr std::size_t max_measured_points = 1'000'000;
constexpr std::size_t max_column_name_bytes = 200;
constexpr std::size_t max_unit_bytes = 40;
constexpr int max_table_columns = 256;
constexpr double max_specimen_length = 1e6;
constexpr int max_blocks = 10'000;

std::optional<std::string> read_text(Fields& fields, std::string_view name, std::size_t max_bytes) {
  const auto* value = fields.optional(name);
  if (!value) return std::nullopt;
  if (!value->is_string() || value->get_ref<const std::string&>().size() > max_bytes) {
    fields.faults().add(fields.at(name), "must be a string of at most " + std::to_string(max_bytes) + " bytes");
    return std::nullopt;
  }
  return value->get<std::string>();
}

/// The bytes that a base64 text encodes, with or without line ends; nullopt where it is no base64.
std::optional<std::string> decoded_base64(std::string_view text) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::array<int, 256> values{};
  values.fill(-1);
  for (std::size_t i = 0; i < alphabet.size(); ++i)
    values[static_cast<unsigned char>(alphabet[i])] = static_cast<int>(i);
  std::string out;
  out.reserve(text.size() / 4 * 3);
  unsigned bits = 0;
  int count = 0;
  std::size_t digits = 0, padding = 0;
  for (const char c : text) {
    if (c == '\n' || c == '\r') continue;
    if (c == '=') {
      ++padding;
      continue;
    }
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0 || padding > 0) return std::nullopt;
    ++digits;
    bits = (bits << 6) | static_cast<unsigned>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out += static_cast<char>((bits >> count) & 0xFF);
  }
  if (digits % 4 == 1 || padding > 2 || (padding > 0 && (digits + padding) % 4 != 0)) return std::nullopt;
  return out;
}

/// Reads the text from the bytes of a file.
void read_content(Fields& fields, std::size_t max_bytes, MeasuredCurveRequest& request) {
  const auto content = read_text(fields, "content", max_bytes);
  if (!content) return;
  const auto bytes = decoded_base64(*content);
  if (!bytes) return fields.faults().add(fields.at("content"), "must be the bytes of a file in base64");
  auto [text, encoding] = design::decode_text(*bytes);
  request.measurements.text = std::move(text);
  request.encoding = std::move(encoding);
  request.text_field = "/content";
}

void read_column(Fields& fields, std::string_view name, design::ColumnChoice& out) {
  const auto* value = fields.optional(name);
  if (!value) return;
  if (value->is_number_integer() && value->get<double>() >= 0 && value->get<double>() < max_table_columns) {
    out = value->get<int>();
  } else if (value->is_string() && value->get_ref<const std::string&>().size() <= max_column_name_bytes) {
    out = value->get<std::string>();
  } else {
    fields.faults().add(fields.at(name), "must be a column's index, an integer from 0 to " +
                                             std::to_string(max_table_columns - 1) + ", or its name in the header");
  }
}

void read_points(Fields& fields, std::vector<Eigen::Vector2d>& out) {
  const auto* points = fields.array("points", false, 2, max_measured_points, "");
  if (!points) return;
  out.resize(points->size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    read_components((*points)[i], fields.at("points") + "/" + std::to_string(i), fields.faults(), out[i], -max_length,
                    max_length);
  }
}

void read_length(Fields& fields, std::string_view name, std::optional<double>& out) {
  double value = 0;
  fields.number(name, value, 0, max_specimen_length, true);
  if (value > 0) out = value;
}

/// Reads how a table is to be parsed.
void read_table_fields(Fields& fields, design::MeasurementRequest& measurements) {
  char separator = 0;
  fields.choice("decimal_separator", separator, decimal_separator_names);
  if (separator != 0) measurements.table.decimal_separator = separator;
  int block = -1;
  fields.integer("block", block, 0, max_blocks - 1);
  if (block >= 0) measurements.table.block = static_cast<std::size_t>(block);
  for (const char* const name : {"columns", "decimal_separator", "block"}) {
    if (fields.present("points") && fields.present(name))
      fields.faults().add(fields.at(name), "must not stand beside \"points\", which are no table");
  }
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

MeasuredCurveRequest parse_measured_curve(std::string_view body, const Limits& limits,
                                          const CancellationToken& cancellation) {
  return read_request<MeasuredCurveRequest>(
      body, limits, cancellation, [&](Fields& fields, MeasuredCurveRequest& request) {
        design::MeasurementRequest& measurements = request.measurements;
        fields.choice("task", measurements.task, task_names);
        measurements.text = read_text(fields, "text", body.size());
        read_content(fields, body.size(), request);
        read_points(fields, measurements.points);
        const int given =
            (fields.present("text") ? 1 : 0) + (fields.present("content") ? 1 : 0) + (fields.present("points") ? 1 : 0);
        if (fields.is_object() && given != 1)
          fields.faults().add("", "must have exactly one of \"text\", \"content\" and \"points\"");
        nested(fields, "columns", [&](Fields& columns) {
          read_column(columns, "x", measurements.x);
          read_column(columns, "y", measurements.y);
        });
        nested(fields, "units", [&](Fields& units) {
          measurements.x_unit = read_text(units, "x", max_unit_bytes);
          measurements.y_unit = read_text(units, "y", max_unit_bytes);
        });
        nested(fields, "specimen", [&](Fields& specimen) {
          read_length(specimen, "gauge_length", measurements.specimen.gauge_length);
          read_length(specimen, "area", measurements.specimen.area);
        });
        read_table_fields(fields, measurements);
        fields.choice("sense", measurements.sense, sense_names);
        fields.choice("zero", measurements.zero, zero_names);
        if (measurements.task != design::Task::stress_strain && measurements.sense != design::Sense::automatic)
          fields.faults().add(fields.at("sense"),
                              "must not be given over directions: it belongs to stress over strain");
        read_range(fields, request.options);
        fields.choice("interpolation", request.options.interpolation, interpolation_names);
        nested(fields, "accuracy", [&](Fields& accuracy) {
          accuracy.number("tolerance", request.options.tolerance, 1e-9, 1);
          accuracy.integer("max_control_points", request.options.max_control_points, 2, 64);
        });
        nested(fields, "effects", [&](Fields& effects) {
          effects.choice("origin", request.options.origin, switch_names);
          effects.choice("loading", request.options.loading, switch_names);
          effects.choice("rupture", request.options.rupture, switch_names);
        });
      });
}

}  // namespace supple::json
