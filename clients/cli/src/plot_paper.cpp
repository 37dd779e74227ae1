#include "plot_paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace supple::cli {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (static_cast<unsigned char>(c) >= 0x20) {
      out += c;
    }
  }
  return out;
}

std::string text_at(Point at, const std::string& text, const char* anchor, double size, const char* color,
                    const char* more) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"{:g}\" fill=\"{}\"{}>{}</text>\n",
                     at.x, at.y, anchor, size, color, more, escaped(text));
}

std::string line(Point from, Point to, const char* color, double width) {
  return fmt::format(
      "<line x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n", from.x,
      from.y, to.x, to.y, color, width);
}

std::string stroke(const std::string& path, const char* color, double width, const char* more) {
  if (path.empty()) return {};
  return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\"{}/>\n", path, color, width,
                     more);
}

std::string dot(Point at, double radius, const char* fill, const char* edge, double width) {
  if (!std::isfinite(at.x) || !std::isfinite(at.y)) return {};
  return fmt::format(
      "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:g}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n", at.x, at.y,
      radius, fill, edge, width);
}

Range widened(Range range) {
  if (!(range.low <= range.high)) return {0, 1};
  if (range.size() > 1e-9 * std::max(std::abs(range.low), std::abs(range.high)) && range.size() > 0) return range;
  const double half = range.high == 0 ? 1 : 0.1 * std::abs(range.high);
  return {range.low - half, range.high + half};
}

double tick_spacing(double range, int count) {
  const double raw = range / count;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power * (1 + 1e-9)) return factor * power;
  }
  return 10 * power;
}

std::vector<double> ticks_of(double low, double high, double spacing) {
  std::vector<double> ticks;
  const auto first = static_cast<long>(std::ceil(low / spacing));
  const auto last = static_cast<long>(std::floor(high / spacing));
  ticks.reserve(static_cast<std::size_t>(std::max(0L, last - first + 1)));
  for (long i = first; i <= last; ++i) ticks.push_back(static_cast<double>(i) * spacing);
  return ticks;
}

std::string tick_text(double value, double spacing) {
  if (std::abs(value) < 1e-9 * spacing) value = 0;
  const std::string text = fmt::format("{:.6g}", std::abs(value));
  return value < 0 ? "\u2212" + text : text;
}

}  // namespace supple::cli
