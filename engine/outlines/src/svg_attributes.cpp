#include "svg_attributes.h"

#include <Eigen/Geometry>
#include <numbers>
#include <stdexcept>

namespace supple::outlines {
namespace {

/// Skips a comma between two numbers, and the blanks around it.
void skip_separator(std::string_view& text) {
  text = without_leading_spaces(text);
  if (text.starts_with(',')) text.remove_prefix(1);
  text = without_leading_spaces(text);
}

/// The map of one function of a transform list.
Map function_of(std::string_view name, const std::vector<double>& n) {
  const auto require_count = [&](std::size_t min_count, std::size_t max_count) {
    if (n.size() < min_count || n.size() > max_count)
      throw std::invalid_argument(in_quotes(name) + " has " + std::to_string(n.size()) + " numbers");
  };
  Map map = Map::Identity();
  constexpr double degree = std::numbers::pi / 180;
  if (name == "matrix") {
    require_count(6, 6);
    map.linear() << n[0], n[2], n[1], n[3];
    map.translation() << n[4], n[5];
  } else if (name == "translate") {
    require_count(1, 2);
    map.translation() << n[0], (n.size() > 1 ? n[1] : 0);
  } else if (name == "scale") {
    require_count(1, 2);
    map.linear() << n[0], 0, 0, (n.size() > 1 ? n[1] : n[0]);
  } else if (name == "rotate") {
    require_count(1, 3);
    if (n.size() == 2) require_count(3, 3);
    const Point about = n.size() > 1 ? Point(n[1], n[2]) : Point::Zero();
    map = Eigen::Translation2d(about) * Eigen::Rotation2Dd(n[0] * degree) * Eigen::Translation2d(-about);
  } else if (name == "skewX" || name == "skewY") {
    require_count(1, 1);
    map.linear()(name == "skewX" ? 0 : 1, name == "skewX" ? 1 : 0) = std::tan(n[0] * degree);
  } else {
    throw std::invalid_argument(in_quotes(name) + " is no function of a transform");
  }
  return map;
}

}  // namespace

std::vector<double> read_numbers(std::string_view text) {
  std::vector<double> numbers;
  text = without_leading_spaces(text);
  while (!text.empty()) {
    const auto number = take_number(text);
    if (!number) throw std::invalid_argument(in_quotes(text.substr(0, 20)) + " is no number");
    numbers.push_back(*number);
    skip_separator(text);
  }
  return numbers;
}

Map read_transform(std::string_view text) {
  Map map = Map::Identity();
  text = without_leading_spaces(text);
  while (!text.empty()) {
    const auto open = text.find('('), close = text.find(')');
    if (open == std::string_view::npos || close == std::string_view::npos || close < open)
      throw std::invalid_argument(in_quotes(text.substr(0, 20)) + " has no pair of parentheses");
    std::string_view name = text.substr(0, open);
    while (!name.empty() && is_space(name.back())) name.remove_suffix(1);
    map = map * function_of(name, read_numbers(text.substr(open + 1, close - open - 1)));
    text.remove_prefix(close + 1);
    skip_separator(text);
  }
  return map;
}

std::optional<double> read_length(std::string_view text) {
  std::string_view rest = without_leading_spaces(text);
  const auto number = take_number(rest);
  while (!rest.empty() && is_space(rest.back())) rest.remove_suffix(1);
  if (!number) throw std::invalid_argument(in_quotes(text) + " is no length");
  if (rest == "%") return std::nullopt;
  if (rest.empty() || rest == "px") return *number;
  const double millimetres = rest == "mm"   ? 1
                             : rest == "cm" ? 10
                             : rest == "in" ? mm_per_inch
                             : rest == "pt" ? mm_per_point
                             : rest == "pc" ? 12 * mm_per_point
                             : rest == "Q"  ? 0.25
                                            : 0;
  if (millimetres == 0)
    throw std::invalid_argument(in_quotes(text) + " is in none of the units mm, cm, in, pt, pc, Q and px");
  return *number * millimetres / mm_per_pixel;
}

Curve ellipse(const Point& centre, double rx, double ry) {
  Curve curve;
  curve.begin = centre + Point(rx, 0);
  curve.closed = true;
  curve.pieces.emplace_back(Arc{centre, {rx, 0}, {0, ry}, 0, 2 * std::numbers::pi, curve.begin});
  return curve;
}

}  // namespace supple::outlines
