#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

// Sizes, colours and SVG elements of plots.
namespace supple::cli {

// Sizes in pixels.
inline constexpr double panel_width = 620;
inline constexpr double panel_height = 470;
inline constexpr double margin_left = 78;
inline constexpr double margin_right = 24;
inline constexpr double margin_top = 84;
inline constexpr double margin_bottom = 62;

inline constexpr auto ink = "#22313f";
inline constexpr auto faint_ink = "#66757f";
inline constexpr auto grid_color = "#e3e8ec";
inline constexpr auto axis_color = "#9aa7b1";

struct Point {
  double x = 0;
  double y = 0;
};

/// The text escaped for an SVG file, without control characters.
std::string escaped(const std::string& text);

/// Elements of an SVG file. `more` are further attributes. An empty path and a dot at a position that is not finite
/// give empty text.
std::string text_at(Point at, const std::string& text, const char* anchor = "middle", double size = 12,
                    const char* color = ink, const char* more = "");
std::string line(Point from, Point to, const char* color, double width = 1);
std::string stroke(const std::string& path, const char* color, double width, const char* more = "");
std::string dot(Point at, double radius, const char* fill, const char* edge, double width = 1.6);

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void add(const std::vector<double>& values) {
    for (const double value : values) add(value);
  }
  double size() const { return high - low; }
};

/// The range; an empty one or one without length is replaced by one around it that has a length.
Range widened(Range range);

/// The spacing of about `count` ticks over `range`: 1, 2 or 5 times a power of ten.
double tick_spacing(double range, int count);
/// Multiples of the spacing from `low` to `high`.
std::vector<double> ticks_of(double low, double high, double spacing);
/// A tick's number with a typographic minus sign; -0 becomes 0.
std::string tick_text(double value, double spacing);

}  // namespace supple::cli
