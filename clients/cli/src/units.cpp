#include "units.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "failure.h"

namespace supple::cli {
namespace {

struct Unit {
  std::string_view name;
  Dimension dimension;
  double factor = 1;  ///< the unit over the base unit of its dimension
};

constexpr double degree = std::numbers::pi / 180;
constexpr double pound_per_square_inch = 0.006894757293168361;  // MPa

constexpr Unit units[] = {{"um", Dimension::length, 1e-3},
                          {"\u00b5m", Dimension::length, 1e-3},  // the micro sign
                          {"\u03bcm", Dimension::length, 1e-3},  // the Greek letter
                          {"mm", Dimension::length},
                          {"cm", Dimension::length, 10},
                          {"m", Dimension::length, 1000},
                          {"in", Dimension::length, 25.4},
                          {"mm2", Dimension::area},
                          {"mm^2", Dimension::area},
                          {"mm\u00b2", Dimension::area},
                          {"cm2", Dimension::area, 100},
                          {"cm^2", Dimension::area, 100},
                          {"cm\u00b2", Dimension::area, 100},
                          {"Pa", Dimension::stress, 1e-6},
                          {"kPa", Dimension::stress, 1e-3},
                          {"MPa", Dimension::stress},
                          {"GPa", Dimension::stress, 1e3},
                          {"N/mm2", Dimension::stress},
                          {"N/mm^2", Dimension::stress},
                          {"N/mm\u00b2", Dimension::stress},
                          {"psi", Dimension::stress, pound_per_square_inch},
                          {"mN", Dimension::force, 1e-3},
                          {"N", Dimension::force},
                          {"kN", Dimension::force, 1e3},
                          {"deg", Dimension::angle, degree},
                          {"\u00b0", Dimension::angle, degree},
                          {"rad", Dimension::angle},
                          {"ms", Dimension::duration, 1e-3},
                          {"s", Dimension::duration},
                          {"min", Dimension::duration, 60},
                          {"h", Dimension::duration, 3600},
                          {"%", Dimension::ratio, 0.01},
                          {"g/cm3", Dimension::density},
                          {"g/cm^3", Dimension::density},
                          {"g/cm\u00b3", Dimension::density},
                          {"kg/m3", Dimension::density, 1e-3},
                          {"kg/m^3", Dimension::density, 1e-3},
                          {"kg/m\u00b3", Dimension::density, 1e-3}};

struct DimensionWords {
  const char* name = nullptr;
  const char* examples = nullptr;
};

DimensionWords words_of(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return {"a length", "4mm, 0.4cm, 4000um, 0.16in, or a number of mm"};
    case Dimension::area:
      return {"an area", "24mm2, 0.24cm2, or a number of mm^2"};
    case Dimension::stress:
      return {"a stress", "12MPa, 0.012GPa, 12000kPa, 12N/mm2, 1740psi, or a number of MPa"};
    case Dimension::force:
      return {"a force", "0.1N, 100mN, or a number of N"};
    case Dimension::angle:
      return {"an angle", "45deg, 0.785rad, or a number of radians"};
    case Dimension::duration:
      return {"a duration", "90s, 1.5min, 500ms, 1h, or a number of seconds"};
    case Dimension::ratio:
      return {"a ratio", "5%, or a number such as 0.05"};
    case Dimension::density:
      return {"a density", "1.2g/cm3, 1200kg/m3, or a number of g/cm^3"};
  }
  return {};
}

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// The number with which a text begins, and what follows it without blanks.
struct NumberAndUnit {
  double number = 0;
  std::string_view unit;
};

std::optional<NumberAndUnit> number_and_unit(std::string_view text) {
  const auto whole = trimmed(text);
  NumberAndUnit read;
  const auto [end, error] = std::from_chars(whole.data(), whole.data() + whole.size(), read.number);
  if (error != std::errc{} || !std::isfinite(read.number)) return std::nullopt;
  read.unit = trimmed(whole.substr(static_cast<std::size_t>(end - whole.data())));
  return read;
}

const Unit* unit_named(std::string_view name) {
  for (const Unit& unit : units)
    if (unit.name == name) return &unit;
  return nullptr;
}

/// The text in base units; nothing where a unit is unknown or of another dimension, in which case `faulty` is set to
/// the quantity at fault. A number without a unit before one with a unit is refused, for in "2x6cm" nobody can know
/// which unit the 2 has; zero is the same in all.
std::optional<std::string> converted(std::string_view text, Dimension dimension, std::string_view& faulty) {
  constexpr std::string_view separators = ",;:x";
  const std::string_view whole = text;
  std::string out;
  bool is_unit_missing = false;
  while (true) {
    const std::size_t end = text.find_first_of(separators);
    const std::string_view part = text.substr(0, end);
    if (const auto read = number_and_unit(part); !read || read->unit.empty()) {
      out += read ? trimmed(part) : part;
      is_unit_missing = is_unit_missing || (read && read->number != 0);
    } else if (is_unit_missing) {
      faulty = trimmed(whole);
      return std::nullopt;
    } else {
      const auto value = quantity_in(part, dimension);
      if (!value) {
        faulty = trimmed(part);
        return std::nullopt;
      }
      out += fmt::format("{}", *value);
    }
    if (end == std::string_view::npos) return out;
    out += text[end];
    text.remove_prefix(end + 1);
  }
}

}  // namespace

std::optional<double> quantity_in(std::string_view text, Dimension dimension) {
  const auto read = number_and_unit(text);
  if (!read) return std::nullopt;
  if (read->unit.empty()) return read->number;
  const Unit* const unit = unit_named(read->unit);
  if (unit == nullptr || unit->dimension != dimension) return std::nullopt;
  const double value = unit->factor * read->number;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<std::vector<double>> quantities_in(std::string_view text, const std::vector<Dimension>& dimensions) {
  std::vector<double> values;
  while (true) {
    const std::size_t comma = text.find(',');
    const auto value = quantity_in(text.substr(0, comma), dimensions[std::min(values.size(), dimensions.size() - 1)]);
    if (!value) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) return values;
    text.remove_prefix(comma + 1);
  }
}

bool is_quantity(std::string_view text) {
  const auto read = number_and_unit(text);
  return read && (read->unit.empty() || unit_named(read->unit) != nullptr);
}

std::string quantity_fault(std::string_view text, Dimension dimension) {
  const auto words = words_of(dimension);
  const std::string_view name = words.name;
  const auto read = number_and_unit(text);
  const Unit* const unit = read ? unit_named(read->unit) : nullptr;
  const bool of_another = unit != nullptr && unit->dimension != dimension;
  return fmt::format("'{}' is no {}{}: write for example {}", text, name.substr(name.find(' ') + 1),
                     of_another ? fmt::format(" but {}", words_of(unit->dimension).name) : "", words.examples);
}

std::string in_base_units(const std::string& text, Dimension dimension, const char* option) {
  std::string_view faulty;
  auto out = converted(text, dimension, faulty);
  if (!out) throw Failure(ExitCode::usage, fmt::format("{}: {}", option, quantity_fault(faulty, dimension)));
  return *std::move(out);
}

CLI::Validator quantity(Dimension dimension) {
  return {[dimension](std::string& text) {
            std::string_view faulty;
            auto out = converted(text, dimension, faulty);
            if (!out) return quantity_fault(faulty, dimension);
            text = *std::move(out);
            return std::string();
          },
          ""};
}

}  // namespace supple::cli
