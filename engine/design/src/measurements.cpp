#include "supple/design/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measured_loading.h"
#include "measured_sense.h"
#include "measured_words.h"
#include "supple/base/error.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

using Column = MeasuredTable::Column;

struct FoundUnit {
  std::string unit;
  bool is_given = false;  ///< by the request or the file
};

/// Collects what the request has to say besides.
class Questions {
 public:
  void add(const std::string& where, const std::string& message) { details_.push_back({where, message}); }
  /// Keeps the details of an error instead of throwing it.
  template <class Function>
  UnitConversion ask(Function convert) {
    try {
      return convert();
    } catch (const Error& error) {
      details_.insert(details_.end(), error.details().begin(), error.details().end());
      return {};
    }
  }
  void throw_if_any() const {
    if (details_.empty()) return;
    std::string sentence;
    for (const auto& detail : details_)
      sentence += (sentence.empty() ? "" : " ") + detail.where + ": " + detail.message + ".";
    throw Error("design.invalid_measurement", sentence, details_);
  }

 private:
  std::vector<Error::Detail> details_;
};

constexpr std::size_t max_quoted_bytes = 80;

std::string quoted(const std::string& text) { return "\"" + shortened(text, max_quoted_bytes) + "\""; }

std::string column_words(const Column& column, std::size_t index) {
  return column.title.empty() ? fmt::format("column {}", index)
                              : fmt::format("column {} {}", index, quoted(column.title));
}

/// A stretch is a ratio near 1: a column of that name that begins near zero is none.
bool is_stretch_ratio(const Column& column) {
  constexpr double least = 0.05, lower = 0.8, upper = 1.25;
  bool begins_at_rest = false;
  for (const double value : column.values) {
    if (std::isnan(value)) continue;
    if (value < least) return false;
    begins_at_rest |= value > lower && value < upper;
  }
  return begins_at_rest;
}

FoundUnit unit_of_points(const std::optional<std::string>& asked, const char* usual) {
  if (!asked) return {usual, true};
  const std::string known = known_unit(*asked);
  return {known.empty() ? *asked : known, true};
}

/// The unit of a column: the request's, else the file's, else the one that its title implies. Asks for it where there
/// is none that is known.
FoundUnit unit_of_column(const std::optional<std::string>& asked, const Column& column, std::size_t index, bool is_x,
                         Task task, Questions& questions) {
  const std::string where = is_x ? "units/x" : "units/y";
  const std::string choices = is_x ? unit_choices_of_x(task) : unit_choices_of_y(task);
  if (asked) {
    const std::string known = known_unit(*asked);
    return {known.empty() ? *asked : known, true};
  }
  const TitleWords words = words_of(column.name);
  const std::string known = known_unit(column.unit);
  if (is_x && words.stretch && task == Task::stress_strain &&
      (column.unit.empty() || known == "1" || known == "stretch")) {
    if (is_stretch_ratio(column)) return {"stretch", true};
    questions.add(where,
                  fmt::format("must be one of {}: {} is called a stretch, and its numbers are not those of lengths "
                              "over the length at rest, which begin near 1",
                              choices, column_words(column, index)));
    return {};
  }
  if (is_x && words.stretch && known == "%" && is_stretch_ratio({{}, {}, {}, [&] {
                                                                   auto values = column.values;
                                                                   for (double& value : values) value /= 100;
                                                                   return values;
                                                                 }()})) {
    questions.add(where, fmt::format("must be one of {}: {} may be a strain or a length over the length at rest",
                                     choices, column_words(column, index)));
    return {};
  }
  if (!known.empty()) return {known, true};
  if (column.unit.empty() && !is_x && task == Task::poisson && words.poisson) return {"1", true};
  const std::string why = column.unit.empty() ? fmt::format("the file names no unit of {}", column_words(column, index))
                                              : fmt::format("{} has the unit {}, which is not known",
                                                            column_words(column, index), quoted(column.unit));
  questions.add(where, fmt::format("must be one of {}: {}", choices, why));
  return {};
}

/// Subtracts the first displacement where that is asked for, and asks where it seems to be needed.
void set_zero(std::vector<Eigen::Vector2d>& raw, ZeroChoice choice, const std::string& unit,
              std::vector<MeasurementNote>& notes, Questions& questions) {
  double least = INFINITY, greatest = -INFINITY, first = NAN;
  for (const auto& p : raw) {
    if (!p.allFinite()) continue;
    if (std::isnan(first)) first = p.x();
    least = std::min(least, p.x());
    greatest = std::max(greatest, p.x());
  }
  if (std::isnan(first) || choice == ZeroChoice::as_written) return;
  if (choice == ZeroChoice::first) {
    for (auto& p : raw) p.x() -= first;
    if (first != 0)
      notes.push_back({fmt::format("Displacements count from the first one, {:.6g} {}.", first, unit), "zero", false});
    return;
  }
  if (std::abs(first) > noticeable_fraction * (greatest - least)) {
    questions.add("zero",
                  fmt::format("must be \"first\" or \"as_written\": the displacement begins at {:.6g} {} and has "
                              "a range of {:.6g} {}, so that it may be a position of the machine",
                              first, unit, greatest - least, unit));
  }
}

void note_unused_specimen(const MeasurementRequest& request, const Measurements& found, bool uses_length,
                          bool uses_area, std::vector<MeasurementNote>& notes) {
  if (request.specimen.gauge_length && !uses_length) {
    notes.push_back({fmt::format("The gauge length was not used: x is in {}, no displacement.", found.x_unit),
                     "specimen/gauge_length", false});
  }
  if (request.specimen.area && !uses_area) {
    notes.push_back(
        {fmt::format("The cross-section was not used: y is in {}, no force.", found.y_unit), "specimen/area", false});
  }
}

void note_sense(const Measurements& found, std::vector<MeasurementNote>& notes) {
  if (found.told_by == SenseTold::nothing)
    notes.push_back({"Nothing in the file tells tension from compression: tension was assumed.", "sense", false});
  if (found.told_by == SenseTold::titles || found.told_by == SenseTold::remarks) {
    notes.push_back({fmt::format("The {} speak of {}{}.", found.told_by == SenseTold::titles ? "titles" : "remarks",
                                 to_string(found.sense),
                                 found.sense == Sense::compression ? ": strains and stresses are negative" : ""),
                     "sense", false});
  }
}

}  // namespace

std::string to_string(Sense sense) {
  switch (sense) {
    case Sense::automatic:
      return "automatic";
    case Sense::tension:
      return "tension";
    case Sense::compression:
      return "compression";
    case Sense::both:
      break;
  }
  return "both";
}

std::string to_string(SenseTold told) {
  switch (told) {
    case SenseTold::request:
      return "request";
    case SenseTold::titles:
      return "titles";
    case SenseTold::remarks:
      return "remarks";
    case SenseTold::signs:
      return "signs";
    case SenseTold::nothing:
      break;
  }
  return "nothing";
}

Measurements read_measurements(const MeasurementRequest& request, const Execution& execution) {
  const StageTimer timer(execution.cost, "reading");
  const bool strains = request.task == Task::stress_strain;
  Measurements found;
  Questions questions;
  std::vector<Eigen::Vector2d> raw;
  SenseSources sources;
  sources.asked = request.sense;
  sources.is_table = request.text.has_value();
  if (request.text) {
    found.table = read_table(*request.text, request.table, execution.cancellation);
    const MeasuredTable& table = *found.table;
    found.columns = choose_columns(table, request.task, request.x, request.y);
    const auto& [x, y, note] = found.columns;
    const Column& x_column = table.columns[x];
    const Column& y_column = table.columns[y];
    found.x_unit = unit_of_column(request.x_unit, x_column, x, true, request.task, questions).unit;
    found.y_unit = unit_of_column(request.y_unit, y_column, y, false, request.task, questions).unit;
    raw.reserve(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i) raw.emplace_back(x_column.values[i], y_column.values[i]);
    sources.x_title = x_column.title;
    sources.y_title = y_column.title;
    sources.unread_titles = table.unread_titles;
    sources.remarks = table.remarks;
    if (!note.empty()) found.notes.push_back({note, "columns", false});
    if (table.blocks > 1) {
      found.notes.push_back(
          {fmt::format("The file has {} blocks of rows: block {} was read.", table.blocks, table.block), "block",
           false});
    }
  } else {
    found.x_unit = unit_of_points(request.x_unit, strains ? "1" : "rad").unit;
    found.y_unit = unit_of_points(request.y_unit, request.task == Task::poisson ? "1" : "MPa").unit;
    raw = request.points;
  }
  UnitConversion x, y;
  if (!found.x_unit.empty())
    x = questions.ask([&] { return conversion_of_x(request.task, found.x_unit, request.specimen); });
  if (!found.y_unit.empty())
    y = questions.ask([&] { return conversion_of_y(request.task, found.y_unit, request.specimen); });
  const bool is_length = strains && quantity_of(found.x_unit) == Quantity::length;
  const bool is_force = strains && quantity_of(found.y_unit) == Quantity::force;
  if (is_length) set_zero(raw, request.zero, found.x_unit, found.notes, questions);
  questions.throw_if_any();
  note_unused_specimen(request, found, is_length, is_force, found.notes);
  found.curve.task = request.task;
  found.curve.points.reserve(raw.size());
  for (const auto& p : raw) found.curve.points.emplace_back(p.x() * x.factor + x.offset, p.y() * y.factor + y.offset);
  if (strains) {
    const FoundSense sense = apply_sense(found.curve, sources);
    found.sense = sense.sense;
    found.told_by = sense.told_by;
    note_sense(found, found.notes);
  }
  return found;
}

}  // namespace supple::design
