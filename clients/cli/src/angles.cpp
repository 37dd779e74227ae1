#include "angles.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "failure.h"
#include "numbers.h"
#include "style.h"
#include "units.h"

namespace supple::cli {
namespace {

using std::numbers::pi;

/// The angle; warns if it is a number without a unit that exceeds a whole turn.
double with_warning(double angle, std::string_view text, const char* option) {
  if (std::abs(angle) > 2 * pi && numbers_in(text))
    print_notice(fmt::format("{} {}: this is in radians and more than a whole turn; {} degrees are written {}deg",
                             option, text, text, text));
  return angle;
}

}  // namespace

std::optional<double> angle_in(std::string_view text) { return quantity_in(text, Dimension::angle); }

double parse_angle(const std::string& text, const char* option) {
  const auto angle = angle_in(text);
  if (!angle) throw Failure(ExitCode::usage, fmt::format("{}: {}", option, quantity_fault(text, Dimension::angle)));
  return with_warning(*angle, text, option);
}

std::vector<double> parse_angles(const std::string& text, const char* option) {
  const std::size_t first_colon = text.find(':');
  const std::size_t second_colon = first_colon == std::string::npos ? first_colon : text.find(':', first_colon + 1);
  if (second_colon != std::string::npos) {
    const double first = parse_angle(text.substr(0, first_colon), option);
    const double last = parse_angle(text.substr(first_colon + 1, second_colon - first_colon - 1), option);
    return parse_series(fmt::format("{:.17g}:{:.17g}{}", first, last, text.substr(second_colon)), "list of angles");
  }
  if (first_colon != std::string::npos)
    throw Failure(ExitCode::usage,
                  fmt::format("{}: '{}' is no list of angles: write them separated by commas, or first:last:n for n of "
                              "them (2 or more)",
                              option, text));
  std::vector<double> angles;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = text.find(',', begin);
    angles.push_back(parse_angle(text.substr(begin, comma - begin), option));
    if (comma == std::string::npos) return angles;
    begin = comma + 1;
  }
}

}  // namespace supple::cli
