#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <pugixml.hpp>
#include <stdexcept>
#include <utility>

#include "svg_attributes.h"

namespace supple::outlines {
namespace {

constexpr int most_groups = 100;
constexpr std::size_t elements_between_checks = 4'096;

/// Without the prefix of a namespace.
std::string_view local_name(const char* name) {
  const std::string_view whole(name);
  const auto colon = whole.rfind(':');
  return colon == std::string_view::npos ? whole : whole.substr(colon + 1);
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_hidden(const pugi::xml_node& node) {
  if (std::string_view(node.attribute("display").value()) == "none") return true;
  std::string style = node.attribute("style").value();
  std::erase_if(style, is_space);
  const auto at = style.find("display:none");
  return at != std::string::npos && (at == 0 || style[at - 1] == ';');
}

/// The names of an element, in front of those of the groups around it.
std::vector<std::string> names_of(const pugi::xml_node& node, const std::vector<std::string>& outer) {
  std::vector<std::string> names;
  const auto add = [&names](std::string_view name) {
    if (!name.empty()) names.push_back(shortened(name));
  };
  add(node.attribute("id").value());
  for (const auto& attribute : node.attributes()) {
    if (local_name(attribute.name()) == "label") add(attribute.value());
  }
  names.insert(names.end(), outer.begin(), outer.end());
  if (names.size() > most_names) names.resize(most_names);
  return names;
}

class SvgReader {
 public:
  SvgReader(std::string_view text, const DrawingOptions& options, const Execution& execution)
      : text_(text), options_(options), execution_(execution) {
    for (std::size_t k = 0; k < text.size(); ++k) {
      if (text[k] == '\n') line_ends_.push_back(static_cast<std::ptrdiff_t>(k));
    }
  }

  RawDrawing read() {
    pugi::xml_document document;
    // Entities other than XML's own stay as they are written, and a document type is passed over.
    const auto result = document.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    execution_.cancellation.throw_if_requested();
    if (!result) {
      refuse("line " + std::to_string(line_of(std::max<std::ptrdiff_t>(result.offset, 0))) + ": " +
             result.description());
    }
    const pugi::xml_node root = document.document_element();
    if (local_name(root.name()) != "svg") refuse("the element " + quoted(root.name()) + " is no <svg>");
    const Map page = at(root, [&] { return page_of(root); });
    read_children(root, page, {}, "page", 1);
    return std::move(drawing_);
  }

 private:
  std::size_t line_of(std::ptrdiff_t offset) const {
    return 1 + static_cast<std::size_t>(std::lower_bound(line_ends_.begin(), line_ends_.end(), offset) -
                                        line_ends_.begin());
  }

  std::string words_for(const pugi::xml_node& node) const {
    const std::string_view id = node.attribute("id").value();
    return "<" + shortened(local_name(node.name())) + ">" + (id.empty() ? "" : " " + quoted(id)) + " of line " +
           std::to_string(line_of(node.offset_debug()));
  }

  /// read(), whose faults are told with the element's place.
  template <class Read>
  auto at(const pugi::xml_node& node, const Read& read) const -> decltype(read()) {
    try {
      return read();
    } catch (const std::invalid_argument& fault) {
      refuse(words_for(node) + ": " + fault.what());
    }
  }

  std::optional<double> length(const pugi::xml_node& node, const char* name) const {
    const auto attribute = node.attribute(name);
    if (!attribute || std::string_view(attribute.value()) == "auto") return std::nullopt;
    const auto value = read_length(attribute.value());
    if (!value) throw std::invalid_argument(std::string(name) + " is a percentage, which has no length here");
    return value;
  }
  double length_or_zero(const pugi::xml_node& node, const char* name) const { return length(node, name).value_or(0); }

  /// From user units to millimetres with y upwards.
  Map page_of(const pugi::xml_node& root) {
    const auto side = [&root](const char* name) -> std::optional<double> {
      const auto attribute = root.attribute(name);
      if (!attribute || std::string_view(attribute.value()) == "auto") return std::nullopt;
      const auto value = read_length(attribute.value());
      if (value && !(*value > 0)) throw std::invalid_argument(std::string(name) + " must be positive");
      return value;
    };
    const auto width = side("width"), height = side("height");
    const auto box = read_numbers(root.attribute("viewBox").value());
    if (!box.empty() && (box.size() != 4 || !(box[2] > 0) || !(box[3] > 0)))
      throw std::invalid_argument("viewBox must be four numbers, of which width and height are positive");
    double bottom = 0;
    Eigen::Vector2d scale(mm_per_pixel, mm_per_pixel), corner = Eigen::Vector2d::Zero();
    drawing_.unit_is_known = width || height;
    if (const auto unit = millimetres_of(options_.unit)) {
      scale.setConstant(*unit);
      drawing_.unit_is_known = true;
      bottom = box.empty() ? height.value_or(0) : box[1] + box[3];
      corner.x() = box.empty() ? 0 : box[0];
    } else if (!box.empty()) {
      const double across = width ? *width / box[2] : height ? *height / box[3] : 1;
      scale = mm_per_pixel * Eigen::Vector2d(across, height ? *height / box[3] : across);
      bottom = box[1] + box[3];
      corner.x() = box[0];
      if (!std::string_view(root.attribute("preserveAspectRatio").value()).starts_with("none")) {
        // The view box is in the middle of the page.
        const Eigen::Vector2d room = scale - Eigen::Vector2d::Constant(scale.minCoeff());
        scale.setConstant(scale.minCoeff());
        corner.x() -= room.x() / scale.x() * box[2] / 2;
        bottom += room.y() / scale.y() * box[3] / 2;
      }
    } else {
      bottom = height.value_or(0);
    }
    drawing_.has_page = !box.empty() || height;
    drawing_.unit = scale.x();
    Map map = Map::Identity();
    map.linear() << scale.x(), 0, 0, -scale.y();
    map.translation() << -scale.x() * corner.x(), scale.y() * bottom;
    return map;
  }

  void read_children(const pugi::xml_node& parent, const Map& map, const std::vector<std::string>& names,
                     const std::string& group, int depth) {
    if (depth > most_groups) {
      const std::string limit = std::to_string(most_groups);
      throw Error("outline.too_large", "The drawing has more than " + limit + " groups within each other.",
                  {{"text", "has more than " + limit + " groups within each other, at " + words_for(parent)}});
    }
    for (const pugi::xml_node& node : parent.children()) {
      if (++read_ % elements_between_checks == 0) execution_.cancellation.throw_if_requested();
      if (node.type() == pugi::node_element) read_element(node, map, names, group, depth);
    }
  }

  void read_element(const pugi::xml_node& node, const Map& outer, const std::vector<std::string>& outer_names,
                    const std::string& group, int depth) {
    const std::string_view name = local_name(node.name());
    const bool is_group = is_one_of(name, {"g", "a", "switch"});
    const bool is_shape = is_one_of(name, {"path", "polygon", "polyline", "line", "rect", "circle", "ellipse"});
    const bool is_other = is_one_of(name, {"use", "text", "image", "svg", "foreignObject"});
    if (!is_group && !is_shape && !is_other) return;
    if (is_hidden(node)) {
      ++drawing_.hidden;
      return;
    }
    if (is_other) {
      leave_out(drawing_, "<" + std::string(name) + ">");
      return;
    }
    const Map map = at(node, [&] { return Map(outer * read_transform(node.attribute("transform").value())); });
    const auto names = names_of(node, outer_names);
    if (is_group) return read_children(node, map, names, group + "/" + std::to_string(node.offset_debug()), depth + 1);
    auto curves = at(node, [&] { return shape_of(node, name); });
    if (curves.empty()) return;
    const std::string what = words_for(node);
    for (Curve& curve : curves) {
      transform(curve, map);
      curve.names = names;
      curve.group = group;
      curve.what = what;
      add_curve(drawing_, std::move(curve), execution_);
    }
  }

  std::vector<Curve> shape_of(const pugi::xml_node& node, std::string_view name) const {
    if (name == "path") return read_path(node.attribute("d").value());
    if (name == "rect") return rectangle(node);
    if (name == "line") {
      Curve curve;
      curve.begin = {length_or_zero(node, "x1"), length_or_zero(node, "y1")};
      curve.pieces.emplace_back(Line{{length_or_zero(node, "x2"), length_or_zero(node, "y2")}});
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
    const Point centre(length_or_zero(node, "cx"), length_or_zero(node, "cy"));
    auto rx = length(node, name == "circle" ? "r" : "rx"), ry = length(node, name == "circle" ? "r" : "ry");
    if (!rx) rx = ry;
    if (!ry) ry = rx;
    if (rx.value_or(0) < 0 || ry.value_or(0) < 0) throw std::invalid_argument("a radius is negative");
    if (rx.value_or(0) == 0 || ry.value_or(0) == 0) return {};
    return {ellipse(centre, *rx, *ry)};
  }

  std::vector<Curve> rectangle(const pugi::xml_node& node) const {
    const double x = length_or_zero(node, "x"), y = length_or_zero(node, "y");
    const double width = length_or_zero(node, "width"), height = length_or_zero(node, "height");
    auto rx = length(node, "rx"), ry = length(node, "ry");
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
    // Middles of the rounded corners, and the directions in which each begins and ends, as SVG draws a rectangle.
    const Point middles[4] = {
        {x + width - a, y + b}, {x + width - a, y + height - b}, {x + a, y + height - b}, {x + a, y + b}};
    const Point directions[5] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    for (int k = 0; k < 4; ++k) {
      const auto corner = [&](const Point& direction) {
        return Point(middles[k] + direction.cwiseProduct(Point(a, b)));
      };
      curve.pieces.emplace_back(Line{corner(directions[k])});
      const Point end = corner(directions[k + 1]);
      if (a > 0 && b > 0) curve.pieces.emplace_back(Arc{middles[k], {a, 0}, {0, b}, (k - 1) * quarter, quarter, end});
    }
    return {curve};
  }

  std::string_view text_;
  std::vector<std::ptrdiff_t> line_ends_;
  const DrawingOptions& options_;
  const Execution& execution_;
  RawDrawing drawing_;
  std::size_t read_ = 0;
};

}  // namespace

RawDrawing read_svg(std::string_view text, const DrawingOptions& options, const Execution& execution) {
  return SvgReader(text, options, execution).read();
}

}  // namespace supple::outlines
