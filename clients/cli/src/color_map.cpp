#include "color_map.h"

#include <algorithm>
#include <cmath>

namespace supple::cli {
namespace {

// Red, green and blue. Lightness (CIE L*) increases from 11 to 90 in almost equal steps.
constexpr std::array<std::array<double, 3>, 6> key_colors = {
    {{32, 18, 77}, {44, 62, 136}, {32, 110, 142}, {38, 156, 128}, {120, 200, 82}, {245, 228, 60}}};

}  // namespace

std::array<std::uint8_t, 3> color_of(double value) {
  const double position = std::clamp(value, 0.0, 1.0) * (key_colors.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(position), key_colors.size() - 2);
  const double fraction = position - static_cast<double>(low);
  std::array<std::uint8_t, 3> color{};
  for (std::size_t i = 0; i < 3; ++i) {
    color[i] =
        static_cast<std::uint8_t>(std::lround((1 - fraction) * key_colors[low][i] + fraction * key_colors[low + 1][i]));
  }
  return color;
}

}  // namespace supple::cli
