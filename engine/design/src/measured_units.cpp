#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <span>

#include "supple/base/error.h"
#include "supple/design/measured_curve.h"

namespace supple::design {
namespace {

/// What the numbers of a unit are, before they are strains, stresses or directions.
enum class Quantity { ratio, stretch, length, angle, pressure, force };

struct Unit {
  std::string_view name;
  Quantity quantity;
  double factor;  ///< to 1, mm, rad, MPa or N
};

constexpr double degree = std::numbers::pi / 180;
constexpr double pound_force = 4.4482216152605;  // N
constexpr double kilogram_force = 9.80665;       // N
constexpr double psi = 0.006894757293168361;     // MPa

constexpr std::array<Unit, 27> units{{
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
    {"N/m^2", Quantity::pressure, 1e-6},
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

/// Other ways to write them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 25> synonyms{{
    {"-", "1"},
    {"mm/mm", "1"},
    {"m/m", "1"},
    {"in/in", "1"},
    {"percent", "%"},
    {"pct", "%"},
    {"\xE2\x80\xB0", "permille"},
    {"\xC2\xB5\xCE\xB5", "microstrain"},
    {"\xCE\xBC\xCE\xB5", "microstrain"},
    {"ustrain", "microstrain"},
    {"\xCE\xBB", "stretch"},
    {"\xC2\xB5m", "um"},
    {"\xCE\xBCm", "um"},
    {"inch", "in"},
    {"degree", "deg"},
    {"degrees", "deg"},
    {"\xC2\xB0", "deg"},
    {"radian", "rad"},
    {"radians", "rad"},
    {"N/mm2", "N/mm^2"},
    {"N/mm\xC2\xB2", "N/mm^2"},
    {"N/m2", "N/m^2"},
    {"N/m\xC2\xB2", "N/m^2"},
    {"lb", "lbf"},
    {"kp", "kgf"},
}};

const Unit* find_unit(std::string_view written) {
  const auto* const synonym =
      std::find_if(synonyms.begin(), synonyms.end(), [&](const auto& pair) { return pair.first == written; });
  const std::string_view name = synonym == synonyms.end() ? written : synonym->second;
  const auto* const unit =
      std::find_if(units.begin(), units.end(), [&](const Unit& candidate) { return candidate.name == name; });
  return unit == units.end() ? nullptr : unit;
}

[[noreturn]] void refuse_unit(const std::string& where, const std::string& message) {
  throw Error("design.invalid_measurement", where + ": " + message + ".", {{where, message}});
}

/// The unit, which must be of one of the quantities.
const Unit& unit_of(const std::string& written, std::span<const Quantity> quantities, const std::string& where) {
  const Unit* const unit = find_unit(written);
  if (unit && std::find(quantities.begin(), quantities.end(), unit->quantity) != quantities.end()) return *unit;
  std::string list;
  for (const Unit& candidate : units) {
    if (std::find(quantities.begin(), quantities.end(), candidate.quantity) == quantities.end()) continue;
    list.append(list.empty() ? "" : ", ").append(candidate.name);
  }
  refuse_unit(where, "must be one of " + list + ", got \"" + written.substr(0, 40) + "\"");
}

/// A positive length or area that a unit needs.
double needed(const std::optional<double>& value, const std::string& unit, const std::string& field,
              const std::string& what) {
  if (value && *value > 0) return *value;
  refuse_unit("specimen/" + field, "must be the specimen's " + what + ", above 0: numbers in " + unit + " need it");
}

}  // namespace

std::string known_unit(const std::string& written) {
  const Unit* const unit = find_unit(written);
  return unit ? std::string(unit->name) : std::string();
}

UnitConversion conversion_of_x(Task task, const std::string& unit, const Specimen& specimen) {
  if (task != Task::stress_strain) return {unit_of(unit, std::array{Quantity::angle}, "units/x").factor, 0};
  const Unit& found = unit_of(unit, std::array{Quantity::ratio, Quantity::stretch, Quantity::length}, "units/x");
  if (found.quantity == Quantity::stretch) return {1, -1};
  if (found.quantity == Quantity::ratio) return {found.factor, 0};
  return {found.factor / needed(specimen.gauge_length, unit, "gauge_length", "gauge length in mm"), 0};
}

UnitConversion conversion_of_y(Task task, const std::string& unit, const Specimen& specimen) {
  if (task == Task::poisson) return {unit_of(unit, std::array{Quantity::ratio}, "units/y").factor, 0};
  if (task == Task::stiffness) return {unit_of(unit, std::array{Quantity::pressure}, "units/y").factor, 0};
  const Unit& found = unit_of(unit, std::array{Quantity::pressure, Quantity::force}, "units/y");
  if (found.quantity == Quantity::pressure) return {found.factor, 0};
  return {found.factor / needed(specimen.area, unit, "area", "cross-section in mm^2"), 0};
}

}  // namespace supple::design
