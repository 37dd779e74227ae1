#include "table_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace supple::cli {
namespace {

/// Numbers below this fraction of the greatest one in their column are zero but for rounding: solvers end at residuals
/// of about this size, and no column shows so many digits.
constexpr double zero_fraction = 1e-9;
/// Numbers of at least this magnitude are written with an exponent rather than with decimals.
constexpr double min_exponential = 1e6;

}  // namespace

double scale_of(const nlohmann::json& values) {
  if (values.is_number()) return std::abs(values.get<double>());
  double scale = 0;
  if (values.is_array())
    for (const auto& value : values) scale = std::max(scale, scale_of(value));
  return scale;
}

double scale_of(std::initializer_list<const nlohmann::json*> columns) {
  double scale = 0;
  for (const nlohmann::json* column : columns) scale = std::max(scale, scale_of(*column));
  return scale;
}

std::string rounded(double value, double scale, int digits) {
  if (std::abs(value) <= zero_fraction * scale) return "0";
  return fmt::format("{:.{}g}", value, digits);
}

std::string rounded(const nlohmann::json& value, double scale, int digits) {
  return value.is_null() ? "-" : rounded(value.get<double>(), scale, digits);
}

std::string error_bar_text(const nlohmann::json& bar, double scale) {
  return bar.is_null() ? "unknown" : rounded(bar.get<double>(), scale, 2);
}

std::string with_decimals(double value) {
  if (!(std::abs(value) < min_exponential)) return fmt::format("{:.5g}", value);
  const std::string text = fmt::format("{:.5f}", value);
  return text == "-0.00000" ? "0.00000" : text;
}

std::string precise(double value) { return value == 0 ? "0" : fmt::format("{:.16g}", value); }

}  // namespace supple::cli
