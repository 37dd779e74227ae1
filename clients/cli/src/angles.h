#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Angles as they are typed: "45deg" and "45°" are in degrees, "0.785rad" and a plain number in radians.
namespace supple::cli {

/// The angle in radians; nothing where the text is none or not finite.
std::optional<double> angle_in(std::string_view text);

/// One angle in radians. `option` is what it was given to, such as "--direction". Throws Failure(usage). A plain number
/// beyond a whole turn is likely meant in degrees: that is said on standard error.
double parse_angle(const std::string& text, const char* option);

/// Angles in radians separated by commas, or "first:last:n" for n of them at equal distances, both ends included.
/// Throws and warns as parse_angle does.
std::vector<double> parse_angles(const std::string& text, const char* option);

}  // namespace supple::cli
