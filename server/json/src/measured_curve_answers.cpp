#include "supple/json/measured_curve_answers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "answer_parts.h"
#include "supple/json/design_requests.h"
#include "supple/json/measured_curve_requests.h"

namespace supple::json {
namespace {

/// More points than this cannot be told apart in a picture.
constexpr std::size_t max_drawn_points = 1000;

/// A number of a sentence, with four digits.
std::string short_number(double value) {
  std::array<char, 32> digits{};
  const int length = std::snprintf(digits.data(), digits.size(), "%.4g", value);
  return {digits.data(), static_cast<std::size_t>(length)};
}

void write_column(JsonWriter& out, const design::MeasuredTable::Column& column) {
  double minimum = INFINITY, maximum = -INFINITY;
  std::size_t missing = 0;
  for (const double value : column.values) {
    if (std::isnan(value)) {
      ++missing;
      continue;
    }
    minimum = std::min(minimum, value);
    maximum = std::max(maximum, value);
  }
  out.begin_object().field("name", column.name).field("unit", column.unit);
  write_number_or_null(out, "least", minimum);
  write_number_or_null(out, "greatest", maximum);
  out.field("missing", missing).end_object();
}

void write_table(JsonWriter& out, const design::MeasuredTable& table, const std::string& encoding) {
  const char delimiter = table.delimiter;
  out.key("table").begin_object().field("rows", table.rows()).field("skipped_lines", table.skipped_lines);
  out.field("delimiter", delimiter == ','    ? "comma"
                         : delimiter == ';'  ? "semicolon"
                         : delimiter == '\t' ? "tab"
                                             : "blank");
  out.field("decimal_separator", decimal_separator_names.name_of(table.decimal_separator)).field("encoding", encoding);
  out.field("block", table.block).field("blocks", table.blocks);
  out.key("columns").begin_array();
  for (const auto& column : table.columns) write_column(out, column);
  out.end_array().end_object();
}

struct AsideReason {
  const char* name;
  const char* words;
  std::size_t count;
};

/// The reasons why points did not count, without those that do not occur.
std::vector<AsideReason> aside_reasons(const MeasuredCurveAnswer& answer) {
  const design::SetAside& aside = answer.curve.set_aside;
  const auto& table = answer.measurements.table;
  std::vector<AsideReason> reasons;
  for (const AsideReason& reason : std::array<AsideReason, 5>{
           {{"no_row", "lines among the rows that do not read like them", table ? table->malformed_lines : 0},
            {"no_number", "without a number", aside.no_number},
            {"out_of_range", "outside of the range asked for", aside.out_of_range},
            {"not_first_loading", "that belong to no first loading, which alone counts", aside.not_first_loading},
            {"after_rupture", "after the break", aside.after_rupture}}}) {
    if (reason.count > 0) reasons.push_back(reason);
  }
  return reasons;
}

/// A curve of which more than this fraction was set aside may not be the one that was meant.
constexpr double min_warned_fraction = 0.1;

std::vector<design::MeasurementNote> notes_of(const MeasuredCurveAnswer& answer) {
  const auto& curve = answer.curve;
  std::vector<design::MeasurementNote> notes = answer.measurements.notes;
  std::size_t aside = 0;
  std::string why;
  for (const auto& reason : aside_reasons(answer)) {
    aside += reason.count;
    why += (why.empty() ? "" : ", ") + std::to_string(reason.count) + " " + reason.words;
  }
  if (aside > 0) {
    const auto all = static_cast<double>(answer.measurements.curve.points.size() +
                                         (answer.measurements.table ? answer.measurements.table->malformed_lines : 0));
    std::string text =
        std::to_string(aside) + (aside == 1 ? " point was" : " points were") + " set aside: " + why + ".";
    if (curve.rupture_at) {
      text.pop_back();
      text += " at the strain " + short_number(*curve.rupture_at) + ".";
    }
    notes.push_back({std::move(text), "", static_cast<double>(aside) > min_warned_fraction * all});
  }
  if (curve.relative_rms > answer.options.tolerance) {
    const bool scatters = curve.noise > 0.5 * curve.relative_rms;
    notes.push_back({scatters ? "The points scatter by more than the tolerance, and the curve does not follow that."
                              : "The curve deviates by more than the tolerance: more control points bring it closer.",
                     scatters ? "" : "accuracy/max_control_points", false});
  }
  return notes;
}

void write_set_aside(JsonWriter& out, const MeasuredCurveAnswer& answer) {
  std::size_t aside = 0;
  for (const auto& reason : aside_reasons(answer)) aside += reason.count;
  out.field("set_aside", aside).key("set_aside_reasons").begin_array();
  for (const auto& reason : aside_reasons(answer))
    out.begin_object().field("reason", reason.name).field("count", reason.count).end_object();
  out.end_array();
}

void write_notes(JsonWriter& out, const std::vector<design::MeasurementNote>& notes) {
  out.key("notes").begin_array();
  std::string message;
  for (const auto& note : notes) {
    message += (message.empty() ? "" : " ") + note.text;
    out.begin_object().field("level", note.is_warning ? "warning" : "note").field("text", note.text);
    out.field("pointer", note.where.empty() ? std::string() : "/" + note.where).end_object();
  }
  out.end_array().field("message", message);
}

}  // namespace

std::string write_measured_curve(const MeasuredCurveAnswer& answer, const Bill& bill) {
  const auto& curve = answer.curve;
  JsonWriter out;
  out.begin_object().field("task", task_names.name_of(answer.task));
  const design::Measurements& measured = answer.measurements;
  if (measured.table) {
    write_table(out, *measured.table, answer.encoding);
    out.key("columns").begin_object().field("x", measured.columns.x).field("y", measured.columns.y).end_object();
  }
  out.key("units").begin_object().field("x", measured.x_unit).field("y", measured.y_unit).end_object();
  if (answer.task == design::Task::stress_strain) {
    out.key("sense").begin_object().field("used", design::to_string(measured.sense));
    out.field("told_by", design::to_string(measured.told_by)).end_object();
  }
  out.key("target").begin_object().key("control_points").begin_array();
  for (const auto& point : curve.control_points) out.numbers(point);
  out.end_array().field("interpolation", interpolation_names.name_of(curve.interpolation)).end_object();
  out.key("points").begin_array();
  const std::size_t n = curve.points.size(), drawn = std::min(n, max_drawn_points);
  for (std::size_t i = 0; i < drawn; ++i) out.numbers(curve.points[drawn < 2 ? 0 : i * (n - 1) / (drawn - 1)]);
  out.end_array().field("point_count", n);
  write_set_aside(out, answer);
  out.key("error").begin_object().field("relative_rms", curve.relative_rms).field("max", curve.max_deviation);
  out.field("max_at", curve.max_at).field("noise", curve.noise).end_object();
  out.field("offset", curve.offset);
  write_notes(out, notes_of(answer));
  out.key("accuracy").begin_object().field("tolerance", answer.options.tolerance);
  out.field("max_control_points", answer.options.max_control_points).end_object();
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
