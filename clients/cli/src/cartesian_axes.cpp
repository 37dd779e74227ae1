#include <fmt/format.h>

#include <cmath>

#include "plot_axes.h"

namespace supple::cli {

Axes cartesian_axes(Range x, Range y, const std::string& x_label, const std::string& y_label) {
  const double left = margin_left;
  const double right = panel_width - margin_right;
  const double top = margin_top;
  const double bottom = panel_height - margin_bottom;
  x = widened(x);
  const double margin = 0.05 * y.size();
  y = {y.low - margin, y.high + margin};
  const double pad = 0.02 * x.size();
  x = {x.low - pad, x.high + pad};
  Axes axes;
  axes.frame.place = [=](double at, double value) {
    return Point{left + (at - x.low) / x.size() * (right - left), bottom - (value - y.low) / y.size() * (bottom - top)};
  };
  const Frame& frame = axes.frame;
  axes.shape = fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", left, top, right - left, bottom - top);
  const double x_step = tick_spacing(x.size(), 8);
  const double y_step = tick_spacing(y.size(), 7);
  for (const double tick : ticks_of(x.low, x.high, x_step)) {
    const double at = frame.place(tick, 0).x;
    axes.grid += line({at, top}, {at, bottom}, std::abs(tick) < 1e-9 * x_step ? axis_color : grid_color);
    axes.grid += line({at, bottom}, {at, bottom + 5}, axis_color);
    axes.grid += text_at({at, bottom + 20}, tick_text(tick, x_step));
  }
  for (const double tick : ticks_of(y.low, y.high, y_step)) {
    const double at = frame.place(0, tick).y;
    axes.grid += line({left, at}, {right, at}, std::abs(tick) < 1e-9 * y_step ? axis_color : grid_color);
    axes.grid += line({left - 5, at}, {left, at}, axis_color);
    axes.grid += text_at({left - 9, at + 4}, tick_text(tick, y_step), "end");
  }
  axes.grid += fmt::format("{} fill=\"none\" stroke=\"{}\" stroke-width=\"1.2\"/>\n", axes.shape, axis_color);
  axes.labels = text_at({(left + right) / 2, bottom + 44}, x_label, "middle", 13);
  const Point aside{22, (top + bottom) / 2};
  axes.labels += text_at(aside, y_label, "middle", 13, ink,
                         fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", aside.x, aside.y).c_str());
  return axes;
}

}  // namespace supple::cli
