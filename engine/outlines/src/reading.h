#pragma once

#include <Eigen/Core>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "curve.h"
#include "supple/base/error.h"
#include "supple/base/execution.h"
#include "supple/outlines/drawing.h"

namespace supple::outlines {

constexpr std::size_t max_curves = 20'000;
/// Curves between two checks for a stop request.
constexpr std::size_t curves_between_checks = 256;
/// Limit of the coordinates, mm, which keeps everything that is computed from them far from overflow.
constexpr double max_coordinate = 1e7;
constexpr std::size_t max_name_bytes = 100;
/// Limit of groups within each other, and of elements that are drawn again within each other.
constexpr int max_nesting = 100;
/// Limit of an element's names: its own, then those of the nearest groups.
constexpr std::size_t max_names = 10;

constexpr double mm_per_inch = 25.4;
constexpr double mm_per_pixel = mm_per_inch / 96;
constexpr double mm_per_point = mm_per_inch / 72;

/// The length of a unit, mm; none for LengthUnit::automatic.
std::optional<double> millimetres_of(LengthUnit unit);

/// The curves of a file, in millimetres, and what else was found in it.
struct RawDrawing {
  std::vector<Curve> curves;
  double unit = 1;
  bool unit_is_known = true;
  bool has_page = true;                       ///< whether there is a page, whose lower left corner is the origin
  std::map<std::string, int> left_out_kinds;  ///< number of elements that no outline is made of, by kind
  std::size_t hidden = 0;                     ///< number of hidden elements
  std::size_t stroked = 0;                    ///< as in `Drawing`
  std::vector<OmittedElement> left_out;       ///< the first elements that were left out or are hidden
  std::size_t left_out_count = 0;             ///< number of all elements that were left out or are hidden
  std::vector<std::string> warnings;
};

RawDrawing read_svg(std::string_view text, const DrawingOptions& options, const Execution& execution);
RawDrawing read_dxf(std::string_view text, const DrawingOptions& options, const Execution& execution);

/// Records an element of which no outline is made, and why. After 20 kinds, all others are counted as one.
void leave_out(RawDrawing& drawing, const std::string& kind, const std::string& element,
               const std::string& reason = "no outline is made of such an element");
/// Records an element that is not shown, and why.
void leave_hidden(RawDrawing& drawing, const std::string& element, const std::string& reason);

/// Throws "outline.unreadable" if the text is a file of another known format, and names that format.
void refuse_other_formats(std::string_view text);

[[noreturn]] inline void refuse(const std::string& message) {
  throw Error("outline.unreadable", "The drawing cannot be read: " + message + ".", {{"text", message}});
}

/// Throws "outline.too_large" if a curve has more pieces than a drawing may have corners.
void check_pieces(std::size_t count);

/// Throws "outline.too_large" for an element at `where` that lies within more than `max_nesting` `things`.
void check_nesting(int depth, const char* things, const std::string& where);

/// Adds a curve. Throws "outline.unreadable" if its coordinates exceed the limit, "outline.too_large" for too many
/// curves.
void add_curve(RawDrawing& drawing, Curve curve, const Execution& execution);

/// A number with four significant digits, for a message.
std::string four_digits(double value);
/// Text of a file for a message: shortened, with "?" for characters that are not printable ASCII.
std::string in_quotes(std::string_view text);
/// The first `max_name_bytes` of a name, without a cut character of UTF-8 at the end.
std::string shortened(std::string_view name);

inline bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }
/// The text without the blanks at its front.
std::string_view without_leading_spaces(std::string_view text);

/// Reads a decimal number at the front of the text, and removes it from there. None for anything else, "inf" or "nan".
std::optional<double> take_number(std::string_view& text);

}  // namespace supple::outlines
