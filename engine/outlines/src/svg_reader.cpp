#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <pugixml.hpp>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "svg_attributes.h"

namespace supple::outlines {
namespace {

/// Elements that are drawn again, since a few of them within each other may stand for any number. So many bytes of
/// attributes count as one more.
constexpr std::size_t most_copies = 200'000;
constexpr std::size_t bytes_of_a_copy = 16;
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
    const auto box = box_of(root);
    // In user units of the page: where its box is drawn, and how large it is.
    Map view = Map::Identity();
    Eigen::Vector2d size(width.value_or(0), height.value_or(0));
    double unit = mm_per_pixel;
    drawing_.unit_is_known = width || height;
    if (const auto wanted = millimetres_of(options_.unit)) {
      unit = *wanted;
      drawing_.unit_is_known = true;
      if (!box.empty()) {
        size = {box[2], box[3]};
        view.translation() << -box[0], -box[1];
      }
    } else if (!box.empty()) {
      const double across = width ? *width / box[2] : height ? *height / box[3] : 1;
      size = {across * box[2], height.value_or(across * box[3])};
      view = view_of(root, box, size);
    }
    drawing_.has_page = !box.empty() || height;
    drawing_.unit = unit * view.linear()(0, 0);
    Map upwards = Map::Identity();
    upwards.linear() << unit, 0, 0, -unit;
    upwards.translation() << 0, unit * size.y();
    page_size_ = box.empty() ? size : Eigen::Vector2d(box[2], box[3]);
    return upwards * view;
  }

  static std::vector<double> box_of(const pugi::xml_node& node) {
    auto box = read_numbers(node.attribute("viewBox").value());
    if (!box.empty() && (box.size() != 4 || !(box[2] > 0) || !(box[3] > 0)))
      throw std::invalid_argument("viewBox must be four numbers, of which width and height are positive");
    return box;
  }

  /// The map of a view box into a space of a size, in whose middle it is unless both may be stretched.
  static Map view_of(const pugi::xml_node& node, const std::vector<double>& box, const Eigen::Vector2d& size) {
    const Eigen::Vector2d extent(box[2], box[3]);
    Eigen::Vector2d scale = size.cwiseQuotient(extent);
    if (!std::string_view(node.attribute("preserveAspectRatio").value()).starts_with("none"))
      scale.setConstant(scale.minCoeff());
    Map map = Map::Identity();
    map.linear() << scale.x(), 0, 0, scale.y();
    map.translation() = (size - scale.cwiseProduct(extent)) / 2 - scale.cwiseProduct(Eigen::Vector2d(box[0], box[1]));
    return map;
  }

  void read_children(const pugi::xml_node& parent, const Map& map, const std::vector<std::string>& names,
                     const std::string& group, int depth) {
    check_nesting(depth, "groups", words_for(parent));
    for (const pugi::xml_node& node : parent.children()) {
      if (++read_ % elements_between_checks == 0) execution_.cancellation.throw_if_requested();
      if (copying_) count_copy(node);
      if (node.type() == pugi::node_element) read_element(node, map, names, group, depth);
    }
  }

  void read_element(const pugi::xml_node& node, const Map& outer, const std::vector<std::string>& outer_names,
                    const std::string& group, int depth) {
    const std::string_view name = local_name(node.name());
    const bool is_group = is_one_of(name, {"g", "a", "switch"});
    const bool is_shape = is_one_of(name, {"path", "polygon", "polyline", "line", "rect", "circle", "ellipse"});
    const bool is_use = name == "use";
    const bool is_other = is_one_of(name, {"text", "image", "svg", "foreignObject"});
    if (!is_group && !is_shape && !is_use && !is_other) return;
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
    if (is_use) return read_use(node, map, names, group + "/" + std::to_string(node.offset_debug()), depth + 1);
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

  void count_copy(const pugi::xml_node& node) {
    std::size_t bytes = 0;
    for (const auto& attribute : node.attributes()) bytes += std::string_view(attribute.value()).size();
    copies_ += 1 + bytes / bytes_of_a_copy;
    if (copies_ <= most_copies) return;
    const std::string limit = std::to_string(most_copies);
    throw Error(
        "outline.too_large", "The drawing draws more than " + limit + " elements, or as much text, again.",
        {{"text", "draws more than " + limit + " elements, or as much text, again by <use>, at " + words_for(node)}});
  }

  /// What a <use> refers to is drawn again. Nothing outside the file is opened.
  void read_use(const pugi::xml_node& node, const Map& outer, const std::vector<std::string>& names,
                const std::string& group, int depth) {
    check_nesting(depth, "groups", words_for(node));
    const pugi::xml_node target = target_of(node);
    count_copy(target ? target : node);
    const std::string_view name = local_name(target.name());
    const Map map = at(node, [&] {
      Map moved = outer * Eigen::Translation2d(length_or_zero(node, "x"), length_or_zero(node, "y"));
      if (name != "symbol") return moved;
      return Map(moved * at(target, [&] { return symbol_of(target, node); }));
    });
    const bool was_copying = std::exchange(copying_, true);
    if (name == "symbol") {
      read_children(target, map, names_of(target, names), group, depth + 1);
    } else if (target && !is_one_of(name, {"svg", "text", "image", "foreignObject"})) {
      read_element(target, map, names, group, depth + 1);
    } else {
      leave_out(drawing_, target ? "<use> of <" + std::string(name) + ">" : "<use> of nothing in the file");
    }
    copying_ = was_copying;
  }

  /// The first element whose id is that of the reference.
  pugi::xml_node target_of(const pugi::xml_node& use) {
    std::string_view reference;
    for (const auto& attribute : use.attributes()) {
      if (local_name(attribute.name()) == "href" && reference.empty()) reference = attribute.value();
    }
    if (!reference.starts_with('#')) return {};
    if (!ids_) {
      ids_.emplace();
      struct Walker : pugi::xml_tree_walker {
        std::unordered_map<std::string_view, pugi::xml_node>& ids;
        explicit Walker(std::unordered_map<std::string_view, pugi::xml_node>& found) : ids(found) {}
        bool for_each(pugi::xml_node& node) override {
          if (const auto id = node.attribute("id")) ids.emplace(id.value(), node);
          return true;
        }
      } walker(*ids_);
      use.root().traverse(walker);
    }
    const auto found = ids_->find(reference.substr(1));
    return found == ids_->end() ? pugi::xml_node() : found->second;
  }

  /// A symbol with a view box fills the space that its use gives it, or the page.
  Map symbol_of(const pugi::xml_node& symbol, const pugi::xml_node& use) const {
    const auto box = box_of(symbol);
    if (box.empty()) return Map::Identity();
    const auto side = [&](const char* name, double page) {
      for (const pugi::xml_node& node : {use, symbol}) {
        const auto attribute = node.attribute(name);
        if (!attribute || std::string_view(attribute.value()) == "auto") continue;
        const auto value = read_length(attribute.value());
        if (value && !(*value > 0)) throw std::invalid_argument(std::string(name) + " must be positive");
        if (value) return *value;
      }
      return page;
    };
    const Eigen::Vector2d size(side("width", page_size_.x()), side("height", page_size_.y()));
    if (!(size.minCoeff() > 0)) throw std::invalid_argument("its view box has no space, because the page has no size");
    return view_of(symbol, box, size);
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
  std::optional<std::unordered_map<std::string_view, pugi::xml_node>> ids_;  ///< once a <use> has asked for one
  Eigen::Vector2d page_size_ = Eigen::Vector2d::Zero();                      ///< in user units within the page
  std::size_t read_ = 0;
  std::size_t copies_ = 0;
  bool copying_ = false;
};

}  // namespace

RawDrawing read_svg(std::string_view text, const DrawingOptions& options, const Execution& execution) {
  return SvgReader(text, options, execution).read();
}

}  // namespace supple::outlines
