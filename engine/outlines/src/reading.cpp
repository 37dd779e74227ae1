#include "reading.h"

#include <algorithm>
#include <array>
#include <utility>

namespace supple::outlines {

std::optional<double> millimetres_of(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::mm:
      return 1;
    case LengthUnit::cm:
      return 10;
    case LengthUnit::m:
      return 1000;
    case LengthUnit::in:
      return mm_per_inch;
    case LengthUnit::ft:
      return 12 * mm_per_inch;
    case LengthUnit::pt:
      return mm_per_point;
    case LengthUnit::px:
      return mm_per_pixel;
    default:
      return std::nullopt;
  }
}

void add_curve(RawDrawing& drawing, Curve curve, const Execution& execution) {
  if (drawing.curves.size() % curves_between_checks == 0) execution.cancellation.throw_if_requested();
  if (drawing.curves.size() >= max_curves) {
    const std::string limit = std::to_string(max_curves);
    throw Error("outline.too_large", "The drawing has more than " + limit + " curves.",
                {{"text", "has more than " + limit + " curves"}});
  }
  bool is_far = false;
  const auto check = [&is_far](const Point& p) { is_far = is_far || !(p.cwiseAbs().maxCoeff() <= max_coordinate); };
  check(curve.begin);
  for (const Piece& piece : curve.pieces) for_each_control_point(piece, check);
  if (is_far) {
    refuse(curve.description + " has coordinates beyond " + std::to_string(static_cast<int>(max_coordinate / 1000)) +
           " m");
  }
  drawing.curves.push_back(std::move(curve));
}

void check_nesting(int depth, const char* things, const std::string& where) {
  if (depth <= max_nesting) return;
  const std::string what = std::string("has more than ") + std::to_string(max_nesting) + " " + things;
  throw Error("outline.too_large", "The drawing " + what + " within each other.",
              {{"text", what + " within each other, at " + where}});
}

void check_pieces(std::size_t count) {
  if (count <= Flattener::max_corners) return;
  const std::string limit = std::to_string(Flattener::max_corners);
  throw Error("outline.too_large", "The drawing has a curve of more than " + limit + " pieces.",
              {{"text", "has a curve of more than " + limit + " pieces"}});
}

namespace {

void note_left_out(RawDrawing& drawing, const std::string& element, const std::string& reason) {
  ++drawing.left_out_count;
  if (drawing.left_out.size() < Drawing::max_left_out) drawing.left_out.push_back({element, reason});
}

}  // namespace

void leave_out(RawDrawing& drawing, const std::string& kind, const std::string& element, const std::string& reason) {
  constexpr std::size_t max_kinds = 20;
  const bool has_own_count = drawing.left_out_kinds.contains(kind) || drawing.left_out_kinds.size() < max_kinds;
  ++drawing.left_out_kinds[has_own_count ? kind : "other elements"];
  note_left_out(drawing, element, reason);
}

void leave_hidden(RawDrawing& drawing, const std::string& element, const std::string& reason) {
  ++drawing.hidden;
  note_left_out(drawing, element, reason);
}

void refuse_other_formats(std::string_view text) {
  struct Kind {
    std::string_view begin;
    const char* name;
    const char* instead;
  };
  constexpr const char* as_drawing = "save it as SVG or ASCII DXF";
  constexpr std::array<Kind, 9> kinds{
      {{"AutoCAD Binary DXF", "a binary DXF file", "save it as ASCII"},
       {"%PDF", "a PDF file", as_drawing},
       {"%!PS", "a PostScript file (EPS or AI)", as_drawing},
       {"\x1F", "a compressed file (svgz)", "unpack it first"},
       {"PK\x03\x04", "a ZIP archive", "unpack it first, or save the drawing as SVG or ASCII DXF"},
       {"ISO-10303-21", "a STEP file", "save a plane of it as DXF"},
       {"GIF8", "a GIF picture", "trace its outline and save that as SVG"},
       {"II*", "a TIFF picture", "trace its outline and save that as SVG"},
       {"{\\rtf", "a text document", as_drawing}}};
  for (const Kind& kind : kinds) {
    if (text.starts_with(kind.begin)) refuse(std::string("it is ") + kind.name + "; " + kind.instead);
  }
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.size() >= 6 && text.starts_with("AC") && std::all_of(text.begin() + 2, text.begin() + 6, is_digit))
    refuse("it is a DWG file; save it as ASCII DXF");
  // The first bytes of pictures are no valid text, and clients may have replaced them.
  constexpr std::size_t head_bytes = 24;
  const std::string_view head = text.substr(0, head_bytes);
  if (head.substr(0, 12).find("PNG\r") != std::string_view::npos)
    refuse("it is a PNG picture; trace its outline and save that as SVG");
  if (head.find("JFIF") != std::string_view::npos || head.find("Exif") != std::string_view::npos)
    refuse("it is a JPEG picture; trace its outline and save that as SVG");
  if (head.find('\0') != std::string_view::npos) refuse("it is no text but a binary file; save it as SVG or ASCII DXF");
}

std::string four_digits(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 4).ptr;
  return {digits, end};
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t max_length = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, max_length)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > max_length ? "...\"" : "\"");
}

std::string shortened(std::string_view name) {
  if (name.size() <= max_name_bytes) return std::string(name);
  std::size_t end = max_name_bytes;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;
  return std::string(name.substr(0, end));
}

std::string_view without_leading_spaces(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  return text;
}

std::optional<double> take_number(std::string_view& text) {
  std::string_view rest = text;
  if (rest.starts_with('+')) rest.remove_prefix(1);
  const std::string_view digits = rest.starts_with('-') ? rest.substr(1) : rest;
  if (digits.empty() || !(digits.front() == '.' || (digits.front() >= '0' && digits.front() <= '9')) ||
      (rest.data() != text.data() && rest.starts_with('-')))
    return std::nullopt;
  double value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text = rest.substr(static_cast<std::size_t>(end - rest.data()));
  return value;
}

}  // namespace supple::outlines
