#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "supple/design/profile.h"

// What the unit and the title of a column say about it.
namespace supple::design {

/// The quantity of a unit. A displacement (length) becomes a strain, and a force a stress, by the specimen's
/// dimensions.
enum class Quantity : std::uint8_t { ratio, stretch, length, angle, pressure, force };

/// The quantity of a unit that conversion_of_x or conversion_of_y accepts; none for other units.
std::optional<Quantity> quantity_of(const std::string& written);
/// Whether it is a unit of a quantity that no profile has: times, temperatures, rates, voltages.
bool is_other_unit(const std::string& written);
/// Lists of the units that x and y may have, for messages.
std::string unit_choices_of_x(Task task);
std::string unit_choices_of_y(Task task);

/// The quantities that the words of a title name, in English, German, French, Spanish, Italian, Dutch, Polish, Russian,
/// Chinese and Japanese. Several may be true: "elongation" is a strain or a displacement.
struct TitleWords {
  bool strain = false;
  bool stretch = false;
  bool displacement = false;
  bool stress = false;
  bool force = false;
  bool angle = false;
  bool stiffness = false;
  bool poisson = false;
  bool other_quantity = false;  ///< a time, an index, a temperature, a rate, a set point, a dimension of the specimen
  bool transverse = false;      ///< perpendicular to the load
  bool true_measure = false;    ///< true (logarithmic) strain, or true stress
  bool tension = false;
  bool compression = false;
};
TitleWords words_of(std::string_view title);

/// Whether remarks name a tensile or a compression test; neither if they name both.
TitleWords words_of_remarks(std::string_view remarks);

}  // namespace supple::design
