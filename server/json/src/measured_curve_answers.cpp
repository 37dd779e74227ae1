#include "supple/json/measured_curve_answers.h"

#include <algorithm>
#include <cmath>

#include "answer_parts.h"

namespace supple::json {
namespace {

/// More points than this cannot be told apart in a picture.
constexpr std::size_t most_drawn = 1000;

void write_column(JsonWriter& out, const design::MeasuredTable::Column& column) {
  double least = INFINITY, greatest = -INFINITY;
  std::size_t missing = 0;
  for (const double value : column.values) {
    if (std::isnan(value)) {
      ++missing;
      continue;
    }
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  out.begin_object().field("name", column.name).field("unit", column.unit);
  write_number_or_null(out, "least", least);
  write_number_or_null(out, "greatest", greatest);
  out.field("missing", missing).end_object();
}

void write_table(JsonWriter& out, const design::MeasuredTable& table) {
  const char delimiter = table.delimiter;
  out.key("table").begin_object().field("rows", table.rows()).field("skipped_lines", table.skipped_lines);
  out.field("delimiter", delimiter == ','    ? "comma"
                         : delimiter == ';'  ? "semicolon"
                         : delimiter == '\t' ? "tab"
                                             : "blank");
  out.field("decimal_separator", table.decimal_separator == '.' ? "point" : "comma");
  out.key("columns").begin_array();
  for (const auto& column : table.columns) write_column(out, column);
  out.end_array().end_object();
}

std::string message_of(const MeasuredCurveAnswer& answer) {
  const auto& curve = answer.curve;
  std::string message;
  const auto add = [&message](const std::string& sentence) { message += (message.empty() ? "" : " ") + sentence; };
  if (curve.set_aside > 0) {
    add(std::to_string(curve.set_aside) + (curve.set_aside == 1 ? " point was" : " points were") + " set aside" +
        (curve.first_loading ? ": only the first loading counts, up to the greatest strain." : "."));
  }
  if (curve.relative_rms > answer.options.tolerance) {
    const bool scatters = curve.noise > 0.5 * curve.relative_rms;
    add(scatters ? "The points scatter by more than the tolerance, and the curve does not follow that."
                 : "The curve deviates by more than the tolerance: more control points bring it closer.");
  }
  return message;
}

}  // namespace

std::string write_measured_curve(const MeasuredCurveAnswer& answer, const Bill& bill) {
  const auto& curve = answer.curve;
  JsonWriter out;
  out.begin_object().field("task", design::to_string(answer.task));
  if (answer.table) {
    write_table(out, *answer.table);
    out.key("columns").begin_object().field("x", answer.x).field("y", answer.y).end_object();
  }
  out.key("units").begin_object().field("x", answer.x_unit).field("y", answer.y_unit).end_object();
  out.key("target").begin_object().key("control_points").begin_array();
  for (const auto& point : curve.control_points) out.numbers(point);
  out.end_array().field("interpolation", numerics::to_string(curve.interpolation)).end_object();
  out.key("points").begin_array();
  const std::size_t n = curve.points.size(), drawn = std::min(n, most_drawn);
  for (std::size_t i = 0; i < drawn; ++i) out.numbers(curve.points[drawn < 2 ? 0 : i * (n - 1) / (drawn - 1)]);
  out.end_array().field("point_count", n).field("set_aside", curve.set_aside);
  out.key("error").begin_object().field("relative_rms", curve.relative_rms).field("max", curve.max_deviation);
  out.field("max_at", curve.max_at).field("noise", curve.noise).end_object();
  out.field("offset", curve.offset).field("message", message_of(answer));
  out.key("accuracy").begin_object().field("tolerance", answer.options.tolerance);
  out.field("max_control_points", answer.options.max_control_points).end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
