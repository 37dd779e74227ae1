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

constexpr std::size_t most_curves = 20'000;
/// Curves between two looks at the cancellation.
constexpr std::size_t curves_between_checks = 256;
/// No coordinate of a drawing is greater, mm: what is computed from coordinates stays far from overflow.
constexpr double largest_coordinate = 1e7;
/// Of a name, bytes.
constexpr std::size_t longest_name = 100;
/// Groups, or what is drawn again, within each other.
constexpr int most_nested = 100;
/// An element's own and those of the nearest groups.
constexpr std::size_t most_names = 10;

constexpr double mm_per_inch = 25.4;
constexpr double mm_per_pixel = mm_per_inch / 96;
constexpr double mm_per_point = mm_per_inch / 72;

/// The millimetres of a unit; none of LengthUnit::automatic.
std::optional<double> millimetres_of(LengthUnit unit);

/// What a file holds, in millimetres.
struct RawDrawing {
  std::vector<Curve> curves;
  double unit = 1;
  bool unit_is_known = true;
  bool has_page = true;                 ///< which tells where the origin is
  std::map<std::string, int> left_out;  ///< kinds of elements that no outline is made of
  std::size_t hidden = 0;
  std::size_t stroked = 0;
  std::vector<LeftOut> list;  ///< of what was left out, and of what is hidden
  std::size_t listed = 0;     ///< as many as there are, of which the list has the first
  std::vector<std::string> warnings;
};

RawDrawing read_svg(std::string_view text, const DrawingOptions& options, const Execution& execution);
RawDrawing read_dxf(std::string_view text, const DrawingOptions& options, const Execution& execution);

/// Counts an element of which no outline is made, and tells why. Many kinds of them are told together.
void leave_out(RawDrawing& drawing, const std::string& kind, const std::string& element,
               const std::string& reason = "no outline is made of such an element");
/// The same of an element that is not shown.
void leave_hidden(RawDrawing& drawing, const std::string& element, const std::string& reason);

/// Throws "outline.unreadable" if the text is that of a file of another kind that is known, and names it.
void refuse_other_formats(std::string_view text);

[[noreturn]] inline void refuse(const std::string& message) {
  throw Error("outline.unreadable", "The drawing cannot be read: " + message + ".", {{"text", message}});
}

/// Throws "outline.too_large" where a curve has more pieces than a drawing has corners.
void check_pieces(std::size_t count);

/// Throws "outline.too_large" for what lies within more than most_nested `things`.
void check_nesting(int depth, const char* things, const std::string& where);

/// Adds a curve, whose coordinates must be within bounds. Throws "outline.too_large".
void add_curve(RawDrawing& drawing, Curve curve, const Execution& execution);

/// A number for a message, with four digits.
std::string rounded(double value);
/// Text of a file for a message: shortened, and without what is not printable ASCII.
std::string in_quotes(std::string_view text);
/// The first bytes of a name, no half characters of UTF-8.
std::string shortened(std::string_view name);

inline bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }
std::string_view without_spaces(std::string_view text);

/// The decimal number at the front of the text, which is taken from it; not "inf" or "nan".
std::optional<double> take_number(std::string_view& text);

}  // namespace supple::outlines
