#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "measured_words.h"
#include "supple/design/design_fault.h"
#include "supple/design/measured_curve.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

struct Unit {
  std::string_view name;
  Quantity quantity;
  double factor;  ///< converts a number into 1, mm, rad, MPa or N
};

constexpr double degree = std::numbers::pi / 180;
constexpr double pound_force = 4.4482216152605;  // N
constexpr double kilogram_force = 9.80665;       // N
constexpr double psi = 0.006894757293168361;     // MPa

constexpr std::array<Unit, 29> units{{
    {"1", Quantity::ratio, 1},
    {"%", Quantity::ratio, 0.01},
    {"permille", Quantity::ratio, 1e-3},
    {"microstrain", Quantity::ratio, 1e-6},
    {"stretch", Quantity::stretch, 1},
    {"um", Quantity::length, 1e-3},
    {"mm", Quantity::length, 1},
    {"cm", Quantity::length, 10},
    {"m", Quantity::length, 1000},
    {"in", Quantity::length, 25.4},
    {"rad", Quantity::angle, 1},
    {"deg", Quantity::angle, degree},
    {"Pa", Quantity::pressure, 1e-6},
    {"kPa", Quantity::pressure, 1e-3},
    {"MPa", Quantity::pressure, 1},
    {"GPa", Quantity::pressure, 1e3},
    {"N/mm^2", Quantity::pressure, 1},
    {"N/cm^2", Quantity::pressure, 0.01},
    {"N/m^2", Quantity::pressure, 1e-6},
    {"kgf/cm^2", Quantity::pressure, kilogram_force / 100},
    {"psi", Quantity::pressure, psi},
    {"ksi", Quantity::pressure, 1000 * psi},
    {"bar", Quantity::pressure, 0.1},
    {"mN", Quantity::force, 1e-3},
    {"N", Quantity::force, 1},
    {"kN", Quantity::force, 1e3},
    {"lbf", Quantity::force, pound_force},
    {"kgf", Quantity::force, kilogram_force},
    {"gf", Quantity::force, kilogram_force / 1000},
}};

/// Other spellings of these units, as normalized_spelling gives them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 68> synonyms{{
    {"-", "1"},
    {"mm/mm", "1"},
    {"m/m", "1"},
    {"in/in", "1"},
    {"in./in.", "1"},
    {"n/n", "1"},
    {"percent", "%"},
    {"pct", "%"},
    {"prozent", "%"},
    {"%strain", "%"},
    {"\xEF\xBC\x85", "%"},
    {"\xE2\x80\xB0", "permille"},
    {"mm/m", "permille"},
    {"\xC2\xB5\xCE\xB5", "microstrain"},
    {"\xCE\xBC\xCE\xB5", "microstrain"},
    {"ustrain", "microstrain"},
    {"ue", "microstrain"},
    {"\xC2\xB5m/m", "microstrain"},
    {"\xCE\xBCm/m", "microstrain"},
    {"um/m", "microstrain"},
    {"\xCE\xBB", "stretch"},
    {"\xC2\xB5m", "um"},
    {"\xCE\xBCm", "um"},
    {"micron", "um"},
    {"microns", "um"},
    {"millimeter", "mm"},
    {"millimetre", "mm"},
    {"\xE3\x8E\x9C", "mm"},
    {"\xE6\xAF\xAB\xE7\xB1\xB3", "mm"},
    {"inch", "in"},
    {"inches", "in"},
    {"in.", "in"},
    {"degree", "deg"},
    {"degrees", "deg"},
    {"grad", "deg"},
    {"\xC2\xB0", "deg"},
    {"radian", "rad"},
    {"radians", "rad"},
    {"pascal", "Pa"},
    {"\xE3\x8E\xAA", "kPa"},
    {"\xE5\x8D\x83\xE5\xB8\x95", "kPa"},
    {"\xE3\x8E\xAB", "MPa"},
    {"\xE5\x85\x86\xE5\xB8\x95", "MPa"},
    {"megapascal", "MPa"},
    {"kilopascal", "kPa"},
    {"mn/m2", "MPa"},
    {"kn/m2", "kPa"},
    {"kn/mm2", "GPa"},
    {"n/mm2", "N/mm^2"},
    {"n/cm2", "N/cm^2"},
    {"n/m2", "N/m^2"},
    {"kgf/cm2", "kgf/cm^2"},
    {"kg/cm2", "kgf/cm^2"},
    {"kp/cm2", "kgf/cm^2"},
    {"lbf/in2", "psi"},
    {"lb/in2", "psi"},
    {"newton", "N"},
    {"newtons", "N"},
    {"\xE7\x89\x9B", "N"},
    {"kilonewton", "kN"},
    {"\xE5\x8D\x83\xE7\x89\x9B", "kN"},
    {"lb", "lbf"},
    {"lbs", "lbf"},
    {"lbsf", "lbf"},
    {"pounds", "lbf"},
    {"kp", "kgf"},
    {"kg", "kgf"},
    {"g", "gf"},
}};

/// Units of quantities that no profile has, as normalized_spelling gives them: times, temperatures, rates, electric
/// signals, energies.
constexpr std::array<std::string_view, 66> other_units{"s",
                                                       "sec",
                                                       "secs",
                                                       "sec.",
                                                       "second",
                                                       "seconds",
                                                       "sekunde",
                                                       "sekunden",
                                                       "ms",
                                                       "min",
                                                       "mins",
                                                       "min.",
                                                       "minute",
                                                       "minutes",
                                                       "h",
                                                       "hr",
                                                       "hrs",
                                                       "hour",
                                                       "hours",
                                                       "std",
                                                       "\xE7\xA7\x92",
                                                       "hz",
                                                       "1/s",
                                                       "s-1",
                                                       "1/min",
                                                       "%/s",
                                                       "%/min",
                                                       "mm/s",
                                                       "mm/min",
                                                       "mm/sec",
                                                       "in/min",
                                                       "in/s",
                                                       "n/s",
                                                       "n/min",
                                                       "kn/s",
                                                       "mpa/s",
                                                       "n/mm",
                                                       "kn/mm",
                                                       "n/m",
                                                       "c",
                                                       "k",
                                                       "f",
                                                       "degc",
                                                       "degf",
                                                       "\xC2\xB0"
                                                       "c",
                                                       "\xC2\xB0"
                                                       "f",
                                                       "\xE2\x84\x83",
                                                       "celsius",
                                                       "v",
                                                       "mv",
                                                       "mv/v",
                                                       "a",
                                                       "ma",
                                                       "w",
                                                       "j",
                                                       "mj",
                                                       "nmm",
                                                       "nm",
                                                       "cycle",
                                                       "cycles",
                                                       "counts",
                                                       "#",
                                                       "rpm",
                                                       "mm2",
                                                       "mm3",
                                                       "db"};

/// Spellings that are refused because only the case of a letter decides the unit: "mPa" is a billionth of "MPa".
constexpr std::array<std::string_view, 7> ambiguous_spellings{"mPa", "MN", "Mn", "mn", "M", "Gf", "GF"};

/// The spelling in lower case without blanks and power signs: "N/mm²" and "N / mm^2" become "n/mm2".
std::string normalized_spelling(std::string_view written) {
  std::string text;
  const std::string lower = lower_case(written);
  for (std::size_t i = 0; i < lower.size(); ++i) {
    if (std::string_view(lower).substr(i).starts_with("\xC2\xB2")) {
      text += '2';
      ++i;
    } else if (std::string_view(lower).substr(i).starts_with("\xC2\xA0")) {
      ++i;
    } else if (lower[i] != ' ' && lower[i] != '^' && lower[i] != '\t') {
      text += lower[i];
    }
  }
  return text;
}

const Unit* find_unit(std::string_view written) {
  while (written.starts_with(' ')) written.remove_prefix(1);
  while (written.ends_with(' ')) written.remove_suffix(1);
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    if (written.size() > 2 && written.front() == open && written.back() == close)
      written = written.substr(1, written.size() - 2);
  }
  const auto named = [](std::string_view name) {
    const auto* const unit =
        std::find_if(units.begin(), units.end(), [&](const Unit& candidate) { return candidate.name == name; });
    return unit == units.end() ? nullptr : unit;
  };
  if (const Unit* const exact = named(written)) return exact;
  if (std::find(ambiguous_spellings.begin(), ambiguous_spellings.end(), written) != ambiguous_spellings.end())
    return nullptr;
  const std::string spelling = normalized_spelling(written);
  const auto* const synonym =
      std::find_if(synonyms.begin(), synonyms.end(), [&](const auto& pair) { return pair.first == spelling; });
  if (synonym != synonyms.end()) return named(synonym->second);
  const auto* const unit = std::find_if(units.begin(), units.end(), [&](const Unit& candidate) {
    return normalized_spelling(candidate.name) == spelling;
  });
  return unit == units.end() ? nullptr : unit;
}

[[noreturn]] void refuse_unit(const std::string& where, const std::string& message) {
  throw MeasurementFault("design.invalid_measurement", where + ": " + message + ".", {{where, message}});
}

std::string list_of(std::span<const Quantity> quantities) {
  std::string list;
  for (const Unit& candidate : units) {
    if (std::find(quantities.begin(), quantities.end(), candidate.quantity) == quantities.end()) continue;
    list.append(list.empty() ? "" : ", ").append(candidate.name);
  }
  return list;
}

/// The unit, which must belong to one of the quantities.
const Unit& unit_of(const std::string& written, std::span<const Quantity> quantities, const std::string& where) {
  const Unit* const unit = find_unit(written);
  if (unit && std::find(quantities.begin(), quantities.end(), unit->quantity) != quantities.end()) return *unit;
  refuse_unit(where, "must be one of " + list_of(quantities) + ", got \"" + written.substr(0, 40) + "\"");
}

/// The length or area of the specimen that a unit needs; it must be positive.
double required_dimension(const std::optional<double>& value, const std::string& unit, const std::string& field,
                          const std::string& what) {
  if (value && *value > 0) return *value;
  refuse_unit("specimen/" + field, "must be the specimen's " + what + ", above 0: numbers in " + unit + " need it");
}

}  // namespace

std::string canonical_unit(const std::string& written) {
  const Unit* const unit = find_unit(written);
  return unit ? std::string(unit->name) : std::string();
}

std::optional<Quantity> quantity_of(const std::string& written) {
  const Unit* const unit = find_unit(written);
  return unit ? std::optional(unit->quantity) : std::nullopt;
}

bool is_other_unit(const std::string& written) {
  const std::string spelling = normalized_spelling(written);
  return std::find(other_units.begin(), other_units.end(), spelling) != other_units.end();
}

std::string unit_choices_of_x(Task task) {
  return task == Task::stress_strain ? list_of(std::array{Quantity::ratio, Quantity::stretch, Quantity::length})
                                     : list_of(std::array{Quantity::angle});
}

std::string unit_choices_of_y(Task task) {
  if (task == Task::poisson) return list_of(std::array{Quantity::ratio});
  if (task == Task::stiffness) return list_of(std::array{Quantity::pressure});
  return list_of(std::array{Quantity::pressure, Quantity::force});
}

UnitConversion conversion_of_x(Task task, const std::string& unit, const Specimen& specimen) {
  if (task != Task::stress_strain) return {unit_of(unit, std::array{Quantity::angle}, "units/x").factor, 0};
  const Unit& found = unit_of(unit, std::array{Quantity::ratio, Quantity::stretch, Quantity::length}, "units/x");
  if (found.quantity == Quantity::stretch) return {1, -1};
  if (found.quantity == Quantity::ratio) return {found.factor, 0};
  return {found.factor / required_dimension(specimen.gauge_length, unit, "gauge_length", "gauge length in mm"), 0};
}

UnitConversion conversion_of_y(Task task, const std::string& unit, const Specimen& specimen) {
  if (task == Task::poisson) return {unit_of(unit, std::array{Quantity::ratio}, "units/y").factor, 0};
  if (task == Task::stiffness) return {unit_of(unit, std::array{Quantity::pressure}, "units/y").factor, 0};
  const Unit& found = unit_of(unit, std::array{Quantity::pressure, Quantity::force}, "units/y");
  if (found.quantity == Quantity::pressure) return {found.factor, 0};
  return {found.factor / required_dimension(specimen.area, unit, "area", "cross-section in mm^2"), 0};
}

}  // namespace supple::design
