#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "supple/training/model_calibration.h"

namespace supple::training {
namespace {

constexpr std::array<const char*, 4> colours{"#1b6ca8", "#c8553d", "#2f8f5b", "#7a4fa3"};
constexpr std::array<const char*, 4> names{"stress, uniaxial", "stiffness, uniaxial", "Poisson's ratio, uniaxial",
                                           "stress at a strain"};

/// A square chart; lengths are in units of the picture.
struct Panel {
  double left;
  double x_min;
  double x_max;
  double y_min;
  double y_max;
  bool logarithmic;  ///< whether the x axis is

  static constexpr double top = 50;
  static constexpr double size = 300;

  double x(double value) const {
    const auto scaled = [this](double v) { return logarithmic ? std::log(v) : v; };
    const double clamped = std::clamp(value, x_min, x_max);
    return left + size * (scaled(clamped) - scaled(x_min)) / (scaled(x_max) - scaled(x_min));
  }
  double y(double value) const {
    return top + size * (1 - (std::clamp(value, y_min, y_max) - y_min) / (y_max - y_min));
  }
};

std::string label(double x, double y, const std::string& anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, text);
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2, style);
}

constexpr const char* grid_style = "stroke=\"#dddddd\"";
constexpr const char* reference_style = "stroke=\"#222222\" stroke-dasharray=\"5 4\"";

std::string frame_of(const Panel& panel, const std::string& title, const std::string& x_label) {
  std::string text = label(panel.left + Panel::size / 2, Panel::top - 14, "middle", title);
  text += label(panel.left + Panel::size / 2, Panel::top + Panel::size + 38, "middle", x_label);
  for (int i = 0; i <= 5; ++i) {
    const double fraction = panel.y_min + (panel.y_max - panel.y_min) * i / 5;
    text += line(panel.left, panel.y(fraction), panel.left + Panel::size, panel.y(fraction), grid_style);
    text += label(panel.left - 6, panel.y(fraction) + 4, "end", fmt::format("{:.0f} %", 100 * fraction));
  }
  return text;
}

std::string x_tick(const Panel& panel, double value, const std::string& text) {
  return line(panel.x(value), Panel::top, panel.x(value), Panel::top + Panel::size, grid_style) +
         label(panel.x(value), Panel::top + Panel::size + 16, "middle", text);
}

std::string curve(const Panel& panel, const std::vector<double>& x, const std::vector<double>& y, const char* colour) {
  std::string points;
  std::string dots;
  for (std::size_t i = 0; i < x.size(); ++i) {
    points += fmt::format("{:.1f},{:.1f} ", panel.x(x[i]), panel.y(y[i]));
    dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", panel.x(x[i]), panel.y(y[i]),
                        colour);
  }
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", points, colour) +
         dots;
}

}  // namespace

std::string calibration_plot(const CalibrationResult& result) {
  const auto& calibration = *result.model.calibration;
  const Panel length_panel{70, 5e-4, 2, 0.5, 1, true};
  const Panel level_panel{460, 0.5, 1, 0.5, 1, false};
  std::string text =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 790 455\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"790\" height=\"455\" fill=\"white\"/>\n";
  text += frame_of(length_panel,
                   fmt::format("Of answers that say &#8220;within x&#8221; ({:.0f} %)", 100 * calibration.level),
                   "x, stated (of Poisson&#8217;s ratio, hundredths)");
  for (const double tick : {0.001, 0.01, 0.1, 1.0})
    text += x_tick(length_panel, tick, fmt::format("{:g} %", 100 * tick));
  text += line(length_panel.left, length_panel.y(calibration.level), length_panel.left + Panel::size,
               length_panel.y(calibration.level), reference_style);
  text += frame_of(level_panel, "Share of answers within their bar", "share that is stated");
  for (const double tick : {0.5, 0.6, 0.7, 0.8, 0.9, 1.0})
    text += x_tick(level_panel, tick, fmt::format("{:.0f} %", 100 * tick));
  text += line(level_panel.x(0.5), level_panel.y(0.5), level_panel.x(1), level_panel.y(1), reference_style);
  for (std::size_t q = 0; q < neural::all_quantities.size(); ++q) {
    const auto& bars = calibration.scales[q].given.judged;
    text += curve(length_panel, bars.stated, bars.observed, colours[q]);
    text += curve(level_panel, result.levels[q].nominal, result.levels[q].observed, colours[q]);
    const double left = 70 + 185 * static_cast<double>(q);
    text += fmt::format("<rect x=\"{:.0f}\" y=\"420\" width=\"14\" height=\"10\" fill=\"{}\"/>\n", left, colours[q]);
    text += label(left + 20, 430, "start", names[q]);
  }
  return text + "</svg>\n";
}

}  // namespace supple::training
