#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "supple/design/profile.h"

// What units and the words of titles say about a column.
namespace supple::design {

/// What the numbers of a unit are, before they are strains, stresses or directions.
enum class Quantity : std::uint8_t { ratio, stretch, length, angle, pressure, force };

/// The quantity of a unit that conversion_of_x or conversion_of_y know; nothing for others.
std::optional<Quantity> quantity_of(const std::string& written);
/// Whether it is a unit of something that no profile has: times, temperatures, rates, voltages.
bool is_other_unit(const std::string& written);
/// The units that x and y may have, as a list for messages.
std::string unit_choices_of_x(Task task);
std::string unit_choices_of_y(Task task);

/// What the words of a title name, in English, German, French, Spanish, Italian, Dutch, Polish, Russian, Chinese and
/// Japanese. Several may be true: "elongation" is a strain or a displacement.
struct TitleWords {
  bool strain = false;
  bool stretch = false;
  bool displacement = false;
  bool stress = false;
  bool force = false;
  bool angle = false;
  bool stiffness = false;
  bool poisson = false;
  bool something_else = false;  ///< a time, an index, a temperature, a rate, a set point, a size of the specimen
  bool transverse = false;      ///< across the load
  bool true_measure = false;    ///< true (logarithmic) strain, true stress
  bool tension = false;
  bool compression = false;
};
TitleWords words_of(std::string_view title);

/// Whether remarks speak of a tensile or of a compression test; neither where they speak of both.
TitleWords words_of_remarks(std::string_view remarks);

}  // namespace supple::design
