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

/// A square of the picture in which a chart is drawn.
struct Panel {
  double left;
  double x_least;
  double x_greatest;
  double y_least;
  double y_greatest;
  bool logarithmic;  ///< in x

  static constexpr double top = 50;
  static constexpr double size = 300;

  double x(double value) const {
    const auto map = [this](double v) { return logarithmic ? std::log(v) : v; };
    const double held = std::clamp(value, x_least, x_greatest);
    return left + size * (map(held) - map(x_least)) / (map(x_greatest) - map(x_least));
  }
  double y(double value) const {
    return top + size * (1 - (std::clamp(value, y_least, y_greatest) - y_least) / (y_greatest - y_least));
  }
};

std::string label(double x, double y, const std::string& anchor, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, words);
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2, style);
}

constexpr const char* grid = "stroke=\"#dddddd\"";
constexpr const char* wanted = "stroke=\"#222222\" stroke-dasharray=\"5 4\"";

std::string frame_of(const Panel& panel, const std::string& title, const std::string& below) {
  std::string text = label(panel.left + Panel::size / 2, Panel::top - 14, "middle", title);
  text += label(panel.left + Panel::size / 2, Panel::top + Panel::size + 38, "middle", below);
  for (int i = 0; i <= 5; ++i) {
    const double share = panel.y_least + (panel.y_greatest - panel.y_least) * i / 5;
    text += line(panel.left, panel.y(share), panel.left + Panel::size, panel.y(share), grid);
    text += label(panel.left - 6, panel.y(share) + 4, "end", fmt::format("{:.0f} %", 100 * share));
  }
  return text;
}

std::string x_tick(const Panel& panel, double value, const std::string& words) {
  return line(panel.x(value), Panel::top, panel.x(value), Panel::top + Panel::size, grid) +
         label(panel.x(value), Panel::top + Panel::size + 16, "middle", words);
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
  const Panel by_bar{70, 5e-4, 2, 0.5, 1, true};
  const Panel by_level{460, 0.5, 1, 0.5, 1, false};
  std::string text =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 790 455\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<rect width=\"790\" height=\"455\" fill=\"white\"/>\n";
  text +=
      frame_of(by_bar, fmt::format("Of answers that say &#8220;within x&#8221; ({:.0f} %)", 100 * calibration.level),
               "x, stated (of Poisson&#8217;s ratio, hundredths)");
  for (const double tick : {0.001, 0.01, 0.1, 1.0}) text += x_tick(by_bar, tick, fmt::format("{:g} %", 100 * tick));
  text +=
      line(by_bar.left, by_bar.y(calibration.level), by_bar.left + Panel::size, by_bar.y(calibration.level), wanted);
  text += frame_of(by_level, "Share of answers within their bar", "share that is stated");
  for (const double tick : {0.5, 0.6, 0.7, 0.8, 0.9, 1.0})
    text += x_tick(by_level, tick, fmt::format("{:.0f} %", 100 * tick));
  text += line(by_level.x(0.5), by_level.y(0.5), by_level.x(1), by_level.y(1), wanted);
  for (std::size_t q = 0; q < neural::all_quantities.size(); ++q) {
    const auto& judged = calibration.scales[q].given.judged;
    text += curve(by_bar, judged.stated, judged.observed, colours[q]);
    text += curve(by_level, result.levels[q].stated, result.levels[q].observed, colours[q]);
    const double at = 70 + 185 * static_cast<double>(q);
    text += fmt::format("<rect x=\"{:.0f}\" y=\"420\" width=\"14\" height=\"10\" fill=\"{}\"/>\n", at, colours[q]);
    text += label(at + 20, 430, "start", names[q]);
  }
  return text + "</svg>\n";
}

}  // namespace supple::training
