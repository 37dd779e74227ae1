#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plot_axes.h"

namespace supple::cli {
namespace {

using std::numbers::pi;

// Sizes in pixels.
constexpr double polar_radius = 166;
constexpr double polar_top = 24;  ///< space above the rim, for the names of directions

}  // namespace

Axes polar_axes(Range values, bool all_around) {
  const Point center{panel_width / 2, margin_top + polar_top + polar_radius};
  values.add(0.0);
  const double step = tick_spacing(values.size(), 5);
  const double inner = std::floor(values.low / step + 1e-9) * step;
  const double outer = std::ceil(values.high / step - 1e-9) * step;
  const auto radius = [=](double value) { return polar_radius * std::max(0.0, value - inner) / (outer - inner); };
  Axes axes;
  axes.frame = {[=](double angle, double value) {
                  return Point{center.x + radius(value) * std::cos(angle), center.y - radius(value) * std::sin(angle)};
                },
                true, all_around};
  const Frame& frame = axes.frame;
  axes.shape = fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"", center.x, center.y, polar_radius);
  const std::array<const char*, 12> names{"0",      "\u03c0/6",  "\u03c0/3",  "\u03c0/2",  "2\u03c0/3", "5\u03c0/6",
                                          "\u03c0", "7\u03c0/6", "4\u03c0/3", "3\u03c0/2", "5\u03c0/3", "11\u03c0/6"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double angle = static_cast<double>(i) * pi / 6;
    const Point rim = frame.place(angle, outer);
    axes.grid += line(center, rim, grid_color);
    const double cosine = std::cos(angle);
    axes.grid += text_at({rim.x + 12 * cosine, rim.y - 14 * std::sin(angle) + 4}, names[i],
                         cosine > 0.1    ? "start"
                         : cosine < -0.1 ? "end"
                                         : "middle");
  }
  const auto rings = static_cast<int>(std::lround((outer - inner) / step));
  for (int ring = 1; ring <= rings; ++ring) {
    const double value = inner + ring * step;
    const bool rim = ring == rings;
    const bool zero = std::abs(value) < 1e-9 * step;
    axes.grid += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.2f}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n",
        center.x, center.y, radius(value), rim || zero ? axis_color : grid_color, rim || zero ? 1.2 : 1.0);
  }
  // The rings' numbers are drawn over the curves, between two rays.
  for (int ring = inner < 0 ? 0 : 1; ring <= rings; ++ring) {
    const double value = inner + ring * step;
    const Point at = frame.place(5 * pi / 12, value);
    axes.labels += text_at({at.x + 3, at.y + 4}, tick_text(value, step), "middle", 11, faint_ink,
                           " stroke=\"#ffffff\" stroke-width=\"3\" paint-order=\"stroke\"");
  }
  return axes;
}

}  // namespace supple::cli
