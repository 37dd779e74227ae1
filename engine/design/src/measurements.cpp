#include "supple/design/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "measured_loading.h"
#include "measured_sense.h"
#include "measured_words.h"
#include "supple/base/error.h"
#include "supple/design/design_fault.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

using Column = MeasuredTable::Column;

struct FoundUnit {
  std::string unit;
  bool is_given = false;  ///< whether the request, the file or a title gives it
};

/// Collects faults of a request, so that one error reports all of them.
class FaultList {
 public:
  void add(const std::string& where, const std::string& message) { details_.push_back({where, message}); }
  /// Converts, or collects the details of the error.
  template <class Function>
  UnitConversion try_conversion(Function convert) {
    try {
      return convert();
    } catch (const MeasurementFault& error) {
      details_.insert(details_.end(), error.details().begin(), error.details().end());
      return {};
    }
  }
  void throw_if_any() const {
    if (details_.empty()) return;
    std::string sentence;
    for (const auto& detail : details_)
      sentence += (sentence.empty() ? "" : " ") + detail.where + ": " + detail.message + ".";
    throw MeasurementFault("design.invalid_measurement", sentence, details_);
  }

 private:
  std::vector<Error::Detail> details_;
};

constexpr std::size_t max_quoted_bytes = 80;

std::string quoted(const std::string& text) { return "\"" + shortened(text, max_quoted_bytes) + "\""; }

std::string column_description(const Column& column, std::size_t index) {
  return column.title.empty() ? fmt::format("column {}", index)
                              : fmt::format("column {} {}", index, quoted(column.title));
}

/// Whether the values of a column can be stretches: some are near 1, and none is near 0.
bool is_stretch(const Column& column) {
  constexpr double min_stretch = 0.05, min_rest_stretch = 0.8, max_rest_stretch = 1.25;
  bool begins_at_rest = false;
  for (const double value : column.values) {
    if (std::isnan(value)) continue;
    if (value < min_stretch) return false;
    begins_at_rest |= value > min_rest_stretch && value < max_rest_stretch;
  }
  return begins_at_rest;
}

FoundUnit unit_of_points(const std::optional<std::string>& requested, const char* default_unit) {
  if (!requested) return {default_unit, true};
  const std::string canonical = canonical_unit(*requested);
  return {canonical.empty() ? *requested : canonical, true};
}

/// The unit of a column: that of the request, or that of the file, or the one that the title implies. Otherwise a fault
/// asks for it.
FoundUnit unit_of_column(const std::optional<std::string>& requested, const Column& column, std::size_t index,
                         bool is_x, Task task, FaultList& faults) {
  const std::string where = is_x ? "units/x" : "units/y";
  const std::string choices = is_x ? unit_choices_of_x(task) : unit_choices_of_y(task);
  if (requested) {
    const std::string canonical = canonical_unit(*requested);
    return {canonical.empty() ? *requested : canonical, true};
  }
  const TitleWords words = words_of(column.name);
  const std::string canonical = canonical_unit(column.unit);
  if (is_x && words.stretch && task == Task::stress_strain &&
      (column.unit.empty() || canonical == "1" || canonical == "stretch")) {
    if (is_stretch(column)) return {"stretch", true};
    faults.add(where, fmt::format("must be one of {}: {} is called a stretch, and its numbers are not those of lengths "
                                  "over the length at rest, which begin near 1",
                                  choices, column_description(column, index)));
    return {};
  }
  if (is_x && words.stretch && canonical == "%" && is_stretch({{}, {}, {}, [&] {
                                                                 auto values = column.values;
                                                                 for (double& value : values) value /= 100;
                                                                 return values;
                                                               }()})) {
    faults.add(where, fmt::format("must be one of {}: {} may be a strain or a length over the length at rest", choices,
                                  column_description(column, index)));
    return {};
  }
  if (!canonical.empty()) return {canonical, true};
  if (column.unit.empty() && !is_x && task == Task::poisson && words.poisson) return {"1", true};
  const std::string why = column.unit.empty()
                              ? fmt::format("the file names no unit of {}", column_description(column, index))
                              : fmt::format("{} has the unit {}, which is not known", column_description(column, index),
                                            quoted(column.unit));
  faults.add(where, fmt::format("must be one of {}: {}", choices, why));
  return {};
}

/// Subtracts the first displacement if the request says so. A fault asks for the choice if displacements begin far from
/// 0.
void set_zero(std::vector<Eigen::Vector2d>& raw, ZeroChoice choice, const std::string& unit,
              std::vector<MeasurementNote>& notes, FaultList& faults) {
  double min_displacement = INFINITY, max_displacement = -INFINITY, first = NAN;
  for (const auto& p : raw) {
    if (!p.allFinite()) continue;
    if (std::isnan(first)) first = p.x();
    min_displacement = std::min(min_displacement, p.x());
    max_displacement = std::max(max_displacement, p.x());
  }
  if (std::isnan(first) || choice == ZeroChoice::as_written) return;
  if (choice == ZeroChoice::first) {
    for (auto& p : raw) p.x() -= first;
    if (first != 0)
      notes.push_back({fmt::format("Displacements count from the first one, {:.6g} {}.", first, unit), "zero", false});
    return;
  }
  if (std::abs(first) > noticeable_fraction * (max_displacement - min_displacement)) {
    faults.add("zero", fmt::format("must be \"first\" or \"as_written\": the displacement begins at {:.6g} {} and has "
                                   "a range of {:.6g} {}, so that it may be a position of the machine",
                                   first, unit, max_displacement - min_displacement, unit));
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
  if (found.told_by == SenseSource::nothing)
    notes.push_back({"Nothing in the file tells tension from compression: tension was assumed.", "sense", false});
  if (found.told_by == SenseSource::titles || found.told_by == SenseSource::remarks) {
    notes.push_back({fmt::format("The {} speak of {}{}.", found.told_by == SenseSource::titles ? "titles" : "remarks",
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

std::string to_string(SenseSource source) {
  switch (source) {
    case SenseSource::request:
      return "request";
    case SenseSource::titles:
      return "titles";
    case SenseSource::remarks:
      return "remarks";
    case SenseSource::signs:
      return "signs";
    case SenseSource::nothing:
      break;
  }
  return "nothing";
}

Measurements read_measurements(const MeasurementRequest& request, const Execution& execution) {
  const StageTimer timer(execution.cost, "reading");
  const bool over_strain = request.task == Task::stress_strain;
  Measurements found;
  FaultList faults;
  std::vector<Eigen::Vector2d> raw;
  SenseHints hints;
  hints.requested = request.sense;
  hints.is_table = request.text.has_value();
  if (request.text) {
    found.table = read_table(*request.text, request.table, execution.cancellation);
    const MeasuredTable& table = *found.table;
    found.columns = choose_columns(table, request.task, request.x, request.y);
    const auto& [x, y, note] = found.columns;
    const Column& x_column = table.columns[x];
    const Column& y_column = table.columns[y];
    found.x_unit = unit_of_column(request.x_unit, x_column, x, true, request.task, faults).unit;
    found.y_unit = unit_of_column(request.y_unit, y_column, y, false, request.task, faults).unit;
    raw.reserve(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i) raw.emplace_back(x_column.values[i], y_column.values[i]);
    hints.x_title = x_column.title;
    hints.y_title = y_column.title;
    hints.unmatched_titles = table.unmatched_titles;
    hints.remarks = table.remarks;
    if (!note.empty()) found.notes.push_back({note, "columns", false});
    if (table.blocks > 1) {
      found.notes.push_back(
          {fmt::format("The file has {} blocks of rows: block {} was read.", table.blocks, table.block), "block",
           false});
    }
  } else {
    found.x_unit = unit_of_points(request.x_unit, over_strain ? "1" : "rad").unit;
    found.y_unit = unit_of_points(request.y_unit, request.task == Task::poisson ? "1" : "MPa").unit;
    raw = request.points;
  }
  UnitConversion x, y;
  if (!found.x_unit.empty())
    x = faults.try_conversion([&] { return conversion_of_x(request.task, found.x_unit, request.specimen); });
  if (!found.y_unit.empty())
    y = faults.try_conversion([&] { return conversion_of_y(request.task, found.y_unit, request.specimen); });
  const bool is_length = over_strain && quantity_of(found.x_unit) == Quantity::length;
  const bool is_force = over_strain && quantity_of(found.y_unit) == Quantity::force;
  if (is_length) set_zero(raw, request.zero, found.x_unit, found.notes, faults);
  faults.throw_if_any();
  note_unused_specimen(request, found, is_length, is_force, found.notes);
  found.curve.task = request.task;
  found.curve.points.reserve(raw.size());
  for (const auto& p : raw) found.curve.points.emplace_back(p.x() * x.factor + x.offset, p.y() * y.factor + y.offset);
  if (over_strain) {
    const FoundSense sense = apply_sense(found.curve, hints);
    found.sense = sense.sense;
    found.told_by = sense.told_by;
    note_sense(found, found.notes);
  }
  return found;
}

}  // namespace supple::design
