#include "supple/outlines/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "chains.h"
#include "reading.h"

namespace supple::outlines {
namespace {

/// Parts have coordinates up to here, mm.
constexpr double largest_part_coordinate = 2000;
/// Corners nearer to each other than this share of the tolerance are one.
constexpr double one_corner = 1e-3;
/// Polygons of less area, in squares of the tolerance, are no outlines.
constexpr double least_area = 1;
/// Coordinates of equal polygons differ by less, mm.
constexpr double equal_coordinates = 1e-4;
/// Open curves that a message names one by one.
constexpr std::size_t most_named = 3;

struct Box {
  Point lower = Point::Constant(INFINITY), upper = Point::Constant(-INFINITY);
  void include(const Points& points) {
    for (const Point& p : points) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
  }
};

double area_of(const Points& points) {
  double twice = 0;
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const Point a = points[k] - points[0], b = points[k + 1] - points[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

/// Drops corners that lie on the one before.
void tidy(Points& points, double least) {
  Points kept;
  for (const Point& p : points) {
    if (kept.empty() || (p - kept.back()).norm() > least) kept.push_back(p);
  }
  while (kept.size() > 1 && (kept.front() - kept.back()).norm() <= least) kept.pop_back();
  points = std::move(kept);
}

/// Equal for polygons of equal corners, wherever they begin and in whichever direction they run.
std::vector<std::int64_t> key_of(const Points& points) {
  std::vector<std::array<std::int64_t, 2>> cells;
  for (const Point& p : points)
    cells.push_back({std::llround(p.x() / equal_coordinates), std::llround(p.y() / equal_coordinates)});
  if (area_of(points) < 0) std::reverse(cells.begin(), cells.end());
  std::rotate(cells.begin(), std::min_element(cells.begin(), cells.end()), cells.end());
  std::vector<std::int64_t> key;
  for (const auto& cell : cells) key.insert(key.end(), cell.begin(), cell.end());
  return key;
}

std::string rounded(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 4).ptr;
  return {digits, end};
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

DrawingFormat format_of(std::string_view text) {
  return without_spaces(text).starts_with('<') ? DrawingFormat::svg : DrawingFormat::dxf;
}

struct Flattened {
  std::vector<Polyline> polylines;
  double chord_error = 0;
};

/// Closed and open polylines in millimetres, at a tolerance in millimetres.
Flattened flatten(const RawDrawing& raw, double tolerance, const Execution& execution) {
  Flattener flattener(tolerance);
  Flattened result;
  for (std::size_t i = 0; i < raw.curves.size(); ++i) {
    if (i % curves_between_checks == 0) execution.cancellation.throw_if_requested();
    const Curve& curve = raw.curves[i];
    Points points = flattener.flatten(curve);
    if (points.size() < 2) continue;
    result.polylines.push_back({std::move(points), curve.closed, curve.names, curve.group, curve.what, 1});
  }
  result.polylines = joined(std::move(result.polylines), tolerance, execution);
  result.chord_error = flattener.chord_error();
  return result;
}

Box box_of_closed(const Flattened& flat) {
  Box box;
  for (const Polyline& polyline : flat.polylines) {
    if (polyline.closed) box.include(polyline.points);
  }
  return box;
}

/// What is wrong with the first of the open curves.
std::string open_words(const std::vector<const Polyline*>& open) {
  std::string words;
  for (std::size_t k = 0; k < std::min(open.size(), most_named); ++k) {
    const Polyline& curve = *open[k];
    const Point &a = curve.points.front(), &b = curve.points.back();
    words += (k == 0 ? "" : "; ") + curve.what;
    words += " ends " + rounded((a - b).norm()) + " mm from where it begins, at (" + rounded(b.x()) + ", " +
             rounded(b.y()) + ")";
  }
  if (open.size() > most_named) words += "; and " + std::to_string(open.size() - most_named) + " more";
  return words;
}

[[noreturn]] void refuse_open(const std::vector<const Polyline*>& open, const RawDrawing& raw) {
  std::string why = open.empty() ? "it holds no curve of any area" : open_words(open);
  for (const auto& [kind, count] : raw.left_out)
    why += "; " + counted(static_cast<std::size_t>(count), kind.c_str(), kind.c_str()) + " left out";
  throw Error("outline.nothing_closed", "The drawing has no closed curve: " + why + ".",
              {{"text", "has no closed curve: " + why}});
}

/// What became no outline.
struct Selection {
  std::vector<const Polyline*> open;
  std::size_t equal = 0;  ///< to another one
  std::size_t tiny = 0;
};

std::vector<const Polyline*> open_ones(const Flattened& flat) {
  std::vector<const Polyline*> open;
  for (const Polyline& polyline : flat.polylines) {
    if (!polyline.closed) open.push_back(&polyline);
  }
  return open;
}

/// The tolerance counts after scaling, which depends on the width before; so it is flattened until both agree.
Flattened flatten_to_width(const RawDrawing& raw, const DrawingOptions& options, const Execution& execution,
                           double& scale) {
  constexpr double first_share = 1e-3;
  constexpr double margin = 0.9;
  constexpr int most_passes = 5;
  Points points;
  for (const Curve& curve : raw.curves) {
    points.push_back(curve.begin);
    for (const Piece& piece : curve.pieces)
      for_each_control_point(piece, [&points](const Point& p) { points.push_back(p); });
  }
  Box extent;
  extent.include(points);
  double tolerance = first_share * std::max((extent.upper - extent.lower).norm(), 1e-9);
  Flattened flat;
  for (int pass = 0; pass < most_passes; ++pass) {
    flat = flatten(raw, tolerance, execution);
    const Box box = box_of_closed(flat);
    const double width = box.upper.x() - box.lower.x();
    if (!(width > 0)) refuse_open(open_ones(flat), raw);
    scale = *options.width / width;
    if (pass > 0 && tolerance * scale <= options.tolerance) break;
    tolerance = margin * options.tolerance / scale;
  }
  return flat;
}

/// Fills the drawing's outlines and what is counted about them.
Selection take_outlines(Flattened& flat, double scale, const DrawingOptions& options, Drawing& drawing) {
  const double tolerance = options.tolerance;
  Selection selection;
  std::set<std::vector<std::int64_t>> known;
  for (Polyline& polyline : flat.polylines) {
    for (Point& p : polyline.points) p *= scale;
    if (!polyline.closed) {
      drawing.open_curves += polyline.curves;
      selection.open.push_back(&polyline);
      continue;
    }
    tidy(polyline.points, one_corner * tolerance);
    if (polyline.points.size() < 3 || std::abs(area_of(polyline.points)) < least_area * tolerance * tolerance) {
      ++selection.tiny;
    } else if (!known.insert(key_of(polyline.points)).second) {
      ++selection.equal;
    } else {
      if (polyline.curves > 1) drawing.joined += polyline.curves;
      drawing.outlines.push_back({std::move(polyline.points), std::move(polyline.names)});
    }
  }
  return selection;
}

/// Finds the bounding box, and moves the drawing to its origin where it has no page or lies far from it; the latter is
/// the answer.
bool place(Drawing& drawing, const RawDrawing& raw) {
  Box box;
  for (const Outline& outline : drawing.outlines) box.include(outline.corners);
  const bool is_far =
      std::max(box.lower.cwiseAbs().maxCoeff(), box.upper.cwiseAbs().maxCoeff()) > largest_part_coordinate;
  if (is_far || !raw.has_page) {
    for (Outline& outline : drawing.outlines) {
      for (Point& p : outline.corners) p -= box.lower;
    }
    box.upper -= box.lower;
    box.lower.setZero();
  }
  drawing.lower = box.lower;
  drawing.upper = box.upper;
  return is_far;
}

void warn(Drawing& drawing, const RawDrawing& raw, const Selection& selection) {
  const auto& [open, equal, tiny] = selection;
  auto& warnings = drawing.warnings;
  warnings = raw.warnings;
  if (!drawing.unit_is_known) {
    warnings.push_back(drawing.format == DrawingFormat::svg ? "The file says no size: its unit is taken as 1/96 inch."
                                                            : "The file says no unit: its unit is taken as 1 mm.");
  }
  if (!open.empty()) warnings.push_back("Open curves were left out: " + open_words(open) + ".");
  if (equal > 0) {
    warnings.push_back(counted(equal, "polygon lies", "polygons lie") +
                       " exactly over another one, which counts once.");
  }
  if (tiny > 0) warnings.push_back(counted(tiny, "closed curve", "closed curves") + " without area left out.");
  if (raw.hidden > 0) warnings.push_back(counted(raw.hidden, "hidden element", "hidden elements") + " left out.");
  for (const auto& [kind, count] : raw.left_out) {
    warnings.push_back(std::to_string(count) + " " + kind + " left out: no outline is made of " +
                       (count == 1 ? "it." : "them."));
  }
}

}  // namespace

const char* to_string(DrawingFormat format) {
  return format == DrawingFormat::svg ? "svg" : format == DrawingFormat::dxf ? "dxf" : "automatic";
}

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
  if (drawing.curves.size() >= most_curves) {
    const std::string limit = std::to_string(most_curves);
    throw Error("outline.too_large", "The drawing has more than " + limit + " curves.",
                {{"text", "has more than " + limit + " curves"}});
  }
  bool far = false;
  const auto look = [&far](const Point& p) { far = far || !(p.cwiseAbs().maxCoeff() <= largest_coordinate); };
  look(curve.begin);
  for (const Piece& piece : curve.pieces) for_each_control_point(piece, look);
  if (far) {
    refuse(curve.what + " has coordinates beyond " + std::to_string(static_cast<int>(largest_coordinate / 1000)) +
           " m");
  }
  drawing.curves.push_back(std::move(curve));
}

void check_nesting(int depth, const char* things, const std::string& where) {
  if (depth <= most_nested) return;
  const std::string what = std::string("has more than ") + std::to_string(most_nested) + " " + things;
  throw Error("outline.too_large", "The drawing " + what + " within each other.",
              {{"text", what + " within each other, at " + where}});
}

void check_pieces(std::size_t count) {
  if (count <= Flattener::most_corners) return;
  const std::string limit = std::to_string(Flattener::most_corners);
  throw Error("outline.too_large", "The drawing has a curve of more than " + limit + " pieces.",
              {{"text", "has a curve of more than " + limit + " pieces"}});
}

void leave_out(RawDrawing& drawing, const std::string& kind) {
  constexpr std::size_t most_kinds = 20;
  const bool is_told = drawing.left_out.contains(kind) || drawing.left_out.size() < most_kinds;
  ++drawing.left_out[is_told ? kind : "other elements"];
}

std::string quoted(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result = "\"";
  for (const char c : text.substr(0, longest)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > longest ? "...\"" : "\"");
}

std::string shortened(std::string_view name) {
  if (name.size() <= longest_name) return std::string(name);
  std::size_t end = longest_name;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;
  return std::string(name.substr(0, end));
}

std::string_view without_spaces(std::string_view text) {
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

Drawing read_drawing(std::string_view text, const DrawingOptions& options, const Execution& execution) {
  execution.checkpoint(0, "reading");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  Drawing drawing;
  drawing.format = options.format == DrawingFormat::automatic ? format_of(text) : options.format;
  RawDrawing raw;
  {
    const StageTimer timer(execution.cost, "reading");
    raw =
        drawing.format == DrawingFormat::svg ? read_svg(text, options, execution) : read_dxf(text, options, execution);
  }
  execution.checkpoint(0.5, "flattening");
  const StageTimer timer(execution.cost, "flattening");
  drawing.curves = raw.curves.size();
  drawing.unit_is_known = raw.unit_is_known || options.width;
  double scale = 1;
  Flattened flat =
      options.width ? flatten_to_width(raw, options, execution, scale) : flatten(raw, options.tolerance, execution);
  drawing.unit = raw.unit * scale;
  drawing.chord_error = flat.chord_error * scale;

  const Selection selection = take_outlines(flat, scale, options, drawing);
  if (drawing.outlines.empty()) refuse_open(selection.open, raw);
  const bool is_far = place(drawing, raw);
  for (const Curve& curve : raw.curves) {
    drawing.rounded += std::any_of(curve.pieces.begin(), curve.pieces.end(),
                                   [](const Piece& piece) { return !std::holds_alternative<Line>(piece); });
  }
  warn(drawing, raw, selection);
  if (is_far) drawing.warnings.push_back("The drawing lay farther than 2000 mm from its origin and was moved there.");
  if (auto* cost = execution.cost) {
    cost->add_quantity("curves", static_cast<double>(drawing.curves));
    std::size_t corners = 0;
    for (const Outline& outline : drawing.outlines) corners += outline.corners.size();
    cost->add_quantity("corners", static_cast<double>(corners));
  }
  execution.checkpoint(1, "flattening");
  return drawing;
}

}  // namespace supple::outlines
