#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Angles as text: "45deg" and "45°" are in degrees, "0.785rad" and a number without a unit in radians.
namespace supple::cli {

/// The angle in radians; nothing if the text is no angle or not finite.
std::optional<double> angle_in(std::string_view text);

/// One angle in radians. `option` is the option that has the text as its value, such as "--direction". Throws
/// Failure(usage). Warns on standard error of a number without a unit beyond a whole turn: it likely means degrees.
double parse_angle(const std::string& text, const char* option);

/// Angles separated by commas, or "first:last:n" for n of them at equal distances, both ends included; in radians.
/// Throws and warns as parse_angle does.
std::vector<double> parse_angles(const std::string& text, const char* option);

}  // namespace supple::cli
