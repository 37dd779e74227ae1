#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

// Numbers as people write them: rounded, without the digits of rounding errors, and never hundreds of digits long.
namespace supple::cli {

/// The greatest absolute value among numbers and arrays of numbers of any depth; 0 if there are none. Null is no
/// number.
double scale_of(const nlohmann::json& values);
/// The same for several of them.
double scale_of(std::initializer_list<const nlohmann::json*> columns);

/// A number with `digits` significant digits. One that is zero but for rounding, relative to the scale of its column,
/// is "0".
std::string rounded(double value, double scale, int digits = 5);
/// The same for a member of an answer, "-" for null.
std::string rounded(const nlohmann::json& value, double scale, int digits = 5);

/// An error bar of a value, "unknown" for null; zero but for rounding is meant relative to the scale of the values.
std::string error_bar_text(const nlohmann::json& bar, double scale);

/// A strain, a stretch or an angle with five decimals, or with an exponent if it is too large for them.
std::string with_decimals(double value);

/// A number with all digits but the last, which is often one of rounding: 0.1 + 0.2 is "0.3".
std::string precise(double value);

}  // namespace supple::cli
