#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Quantities as text: a number, perhaps with a unit, such as "4mm", "12 MPa", "30deg", "5%" or "2 min". A number
// without a unit is in the base unit of its dimension.
namespace supple::cli {

/// What a quantity measures. The base units are mm, mm^2, MPa, N, radians, seconds, 1 and g/cm^3.
enum class Dimension { length, area, stress, force, angle, duration, ratio, density };

/// The quantity in the base unit of the dimension; nothing if the text is no finite number, or has a unit that is
/// unknown or of another dimension.
std::optional<double> quantity_in(std::string_view text, Dimension dimension);

/// Quantities separated by commas, each of its dimension, and those beyond the list of the last one; nothing if one of
/// them is none of its dimension.
std::optional<std::vector<double>> quantities_in(std::string_view text, const std::vector<Dimension>& dimensions);

/// Whether a text is a finite number, perhaps with a unit of any dimension.
bool is_quantity(std::string_view text);

/// A sentence that says why a text is no quantity of the dimension, and how one is written.
std::string quantity_fault(std::string_view text, Dimension dimension);

/// The text, whose quantities with a unit are replaced by their numbers in the base unit. Commas, semicolons, colons
/// and crosses may separate several, as in "20mm x 6cm" and "0%:10%:5"; what has no unit remains as it is. Throws
/// Failure(usage), which names the option, where a unit is unknown or of another dimension.
std::string in_base_units(const std::string& text, Dimension dimension, const char* option);

/// The same for the values of an option, as the first of its checks (`transform`).
CLI::Validator quantity(Dimension dimension);

}  // namespace supple::cli
