#include "svg_shapes.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <string>

#include "svg_attributes.h"

namespace supple::outlines {
namespace {

/// The length that is 100 % of an attribute: the width, the height or, for other attributes, the diagonal over
/// sqrt(2).
double percentage_base(std::string_view name, const Eigen::Vector2d& viewport) {
  if (is_one_of(name, {"x", "x1", "x2", "cx", "rx", "width"})) return viewport.x();
  if (is_one_of(name, {"y", "y1", "y2", "cy", "ry", "height"})) return viewport.y();
  return viewport.norm() / std::numbers::sqrt2;
}

std::vector<Curve> rectangle(const pugi::xml_node& node, const SvgLengths& lengths) {
  const double x = lengths.or_zero(node, "x"), y = lengths.or_zero(node, "y");
  const double width = lengths.or_zero(node, "width"), height = lengths.or_zero(node, "height");
  auto rx = lengths.of(node, "rx"), ry = lengths.of(node, "ry");
  if (width < 0 || height < 0 || rx.value_or(0) < 0 || ry.value_or(0) < 0)
    throw std::invalid_argument("a width, height or radius is negative");
  if (width == 0 || height == 0) return {};
  if (!rx) rx = ry;
  if (!ry) ry = rx;
  const double a = std::min(rx.value_or(0), width / 2), b = std::min(ry.value_or(0), height / 2);
  Curve curve;
  curve.closed = true;
  curve.begin = {x + a, y};
  constexpr double quarter = std::numbers::pi / 2;
  // The centres of the rounded corners, and the directions in which each of them begins and ends, in the order in
  // which SVG draws a rectangle.
  const Point centres[4] = {
      {x + width - a, y + b}, {x + width - a, y + height - b}, {x + a, y + height - b}, {x + a, y + b}};
  const Point directions[5] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (int k = 0; k < 4; ++k) {
    const auto corner = [&](const Point& direction) { return Point(centres[k] + direction.cwiseProduct(Point(a, b))); };
    curve.pieces.emplace_back(Line{corner(directions[k])});
    const Point end = corner(directions[k + 1]);
    if (a > 0 && b > 0) curve.pieces.emplace_back(Arc{centres[k], {a, 0}, {0, b}, (k - 1) * quarter, quarter, end});
  }
  return {curve};
}

}  // namespace

std::optional<double> SvgLengths::of(const pugi::xml_node& node, const char* name) const {
  std::string text = node.attribute(name).value();
  if (const std::string* const own = styled.find(name)) text = *own;
  if (!node.attribute(name) && text.empty()) return std::nullopt;
  if (text == "auto") return std::nullopt;
  if (const auto value = read_length(text)) return value;
  if (!(viewport.minCoeff() > 0))
    throw std::invalid_argument(std::string(name) + " is a percentage, but the page has no size");
  std::string_view rest = without_leading_spaces(text);
  return *take_number(rest) / 100 * percentage_base(name, viewport);
}
std::vector<Curve> shape_of(const pugi::xml_node& node, std::string_view name, const SvgLengths& lengths) {
  if (name == "path") return read_path(node.attribute("d").value());
  if (name == "rect") return rectangle(node, lengths);
  if (name == "line") {
    Curve curve;
    curve.begin = {lengths.or_zero(node, "x1"), lengths.or_zero(node, "y1")};
    curve.pieces.emplace_back(Line{{lengths.or_zero(node, "x2"), lengths.or_zero(node, "y2")}});
    return {curve};
  }
  if (name == "polygon" || name == "polyline") {
    const auto numbers = read_numbers(node.attribute("points").value());
    if (numbers.size() % 2 != 0) throw std::invalid_argument("points has an odd number of coordinates");
    if (numbers.size() < 4) return {};
    check_pieces(numbers.size() / 2);
    Curve curve;
    curve.begin = {numbers[0], numbers[1]};
    curve.closed = name == "polygon";
    for (std::size_t k = 2; k < numbers.size(); k += 2) curve.pieces.emplace_back(Line{{numbers[k], numbers[k + 1]}});
    return {curve};
  }
  const Point centre(lengths.or_zero(node, "cx"), lengths.or_zero(node, "cy"));
  auto rx = lengths.of(node, name == "circle" ? "r" : "rx"), ry = lengths.of(node, name == "circle" ? "r" : "ry");
  if (!rx) rx = ry;
  if (!ry) ry = rx;
  if (rx.value_or(0) < 0 || ry.value_or(0) < 0) throw std::invalid_argument("a radius is negative");
  if (rx.value_or(0) == 0 || ry.value_or(0) == 0) return {};
  return {ellipse(centre, *rx, *ry)};
}

}  // namespace supple::outlines
