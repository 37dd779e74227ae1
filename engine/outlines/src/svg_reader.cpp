#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <map>
#include <memory>
#include <numbers>
#include <pugixml.hpp>
#include <stdexcept>
#include <utility>

#include "svg_attributes.h"
#include "svg_style.h"

namespace supple::outlines {
namespace {

/// Limit of the elements that are drawn again, since their number grows exponentially with nested <use> elements.
constexpr std::size_t max_copies = 200'000;
/// This many bytes of attributes count as one more copy, and so does this number of attributes.
constexpr std::size_t bytes_per_copy = 16;
constexpr std::size_t attributes_per_copy = 16;
/// Limit of the attributes of one element, since each lookup searches all of them. Programs write some dozens.
constexpr std::size_t max_attributes = 1'000;
constexpr std::size_t elements_between_checks = 4'096;

constexpr double pixels_per_inch = 96;
/// Bytes at the beginning of a file in which the program that wrote it is named.
constexpr std::size_t searched_head_bytes = 4'096;
/// The first version of Inkscape with 96 pixels per inch.
constexpr double first_inkscape_with_96 = 0.92;

/// The name without the prefix of its namespace.
std::string_view local_name(const char* name) {
  const std::string_view whole(name);
  const auto colon = whole.rfind(':');
  return colon == std::string_view::npos ? whole : whole.substr(colon + 1);
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The names of an element, in front of those of the groups around it.
std::vector<std::string> names_of(const pugi::xml_node& node, const std::vector<std::string>& outer) {
  std::vector<std::string> names;
  const auto add = [&names](std::string_view name) {
    if (!name.empty()) names.push_back(shortened(name));
  };
  add(node.attribute("id").value());
  for (const auto& attribute : node.attributes()) {
    const std::string_view name(attribute.name());
    if (name.ends_with("label") && local_name(attribute.name()) == "label") add(attribute.value());
  }
  names.insert(names.end(), outer.begin(), outer.end());
  if (names.size() > max_names) names.resize(max_names);
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
    // Entities other than XML's own stay as they are written, and a document type is skipped.
    const auto result = document.load_buffer(text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
    execution_.cancellation.throw_if_requested();
    if (!result) {
      refuse("line " + std::to_string(line_of(std::max<std::ptrdiff_t>(result.offset, 0))) + ": " +
             result.description());
    }
    const pugi::xml_node root = document.document_element();
    if (local_name(root.name()) != "svg") refuse("the element " + in_quotes(root.name()) + " is no <svg>");
    read_styles(document);
    const Map page = located(root, [&] { return page_of(root); });
    Context context{
        page, located(root, [&] { return style_of(styles_.declared(root), Style{}); }), {}, "page", {}, page_size_, 1};
    if (!context.style.is_displayed) refuse("the drawing as a whole is hidden (display: none)");
    context = clipped(root, context);
    read_children(root, context);
    return std::move(drawing_);
  }

 private:
  /// The properties that an element has from the groups around it.
  struct Context {
    Map map = Map::Identity();
    Style style;
    std::vector<std::string> names;
    std::string group;
    std::shared_ptr<const Clip> clip;
    Eigen::Vector2d viewport = Eigen::Vector2d::Zero();  ///< the lengths that are 100 %; zero if they are unknown
    int depth = 1;
  };

  void read_styles(pugi::xml_document& document) {
    for (const pugi::xml_node& node : document.children()) {
      if (node.type() == pugi::node_pi && std::string_view(node.name()) == "xml-stylesheet")
        drawing_.warnings.emplace_back("The style sheet that the file refers to is not opened: it may hide shapes.");
    }
    struct Walker : pugi::xml_tree_walker {
      std::vector<pugi::xml_node> styles;
      bool for_each(pugi::xml_node& node) override {
        if (node.type() == pugi::node_element && local_name(node.name()) == "style") styles.push_back(node);
        return true;
      }
    } walker;
    document.traverse(walker);
    for (const pugi::xml_node& node : walker.styles) {
      const std::string_view media = node.attribute("media").value();
      if (!media.empty() && media != "all" && media != "screen") continue;
      std::string text;
      for (const pugi::xml_node& child : node.children()) text += child.value();
      styles_.add(text, [&](const std::string& rule) {
        drawing_.warnings.push_back("The rule " + in_quotes(rule) + " of " + describe(node) +
                                    " is not followed: it may hide or show shapes.");
      });
    }
  }

  std::size_t line_of(std::ptrdiff_t offset) const {
    return 1 + static_cast<std::size_t>(std::lower_bound(line_ends_.begin(), line_ends_.end(), offset) -
                                        line_ends_.begin());
  }

  std::string describe(const pugi::xml_node& node) const {
    const std::string_view id = node.attribute("id").value();
    return "<" + shortened(local_name(node.name())) + ">" + (id.empty() ? "" : " " + in_quotes(id)) + " of line " +
           std::to_string(line_of(node.offset_debug()));
  }

  /// Calls read(). If it throws, the drawing is refused with a message that names the element and its line.
  template <class Read>
  auto located(const pugi::xml_node& node, const Read& read) const -> decltype(read()) {
    try {
      return read();
    } catch (const std::invalid_argument& fault) {
      refuse(describe(node) + ": " + fault.what());
    }
  }

  /// The length that is 100 % of an attribute: the width, the height or, for other attributes, the diagonal over
  /// sqrt(2).
  static double percentage_base(std::string_view name, const Eigen::Vector2d& viewport) {
    if (is_one_of(name, {"x", "x1", "x2", "cx", "rx", "width"})) return viewport.x();
    if (is_one_of(name, {"y", "y1", "y2", "cy", "ry", "height"})) return viewport.y();
    return viewport.norm() / std::numbers::sqrt2;
  }

  /// A length of an element, in user units, which a style may set. None for "auto".
  std::optional<double> length(const pugi::xml_node& node, const char* name, const Eigen::Vector2d& viewport) const {
    std::string text = node.attribute(name).value();
    if (const std::string* const own = styled_lengths_.find(name)) text = *own;
    if (!node.attribute(name) && text.empty()) return std::nullopt;
    if (text == "auto") return std::nullopt;
    if (const auto value = read_length(text)) return value;
    if (!(viewport.minCoeff() > 0))
      throw std::invalid_argument(std::string(name) + " is a percentage, but the page has no size");
    std::string_view rest = without_leading_spaces(text);
    return *take_number(rest) / 100 * percentage_base(name, viewport);
  }
  double length_or_zero(const pugi::xml_node& node, const char* name, const Eigen::Vector2d& viewport) const {
    return length(node, name, viewport).value_or(0);
  }

  /// The map from user units to millimetres with y upwards.
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
    // The map of the view box and the size of the page, in user units of the page.
    Map view = Map::Identity();
    Eigen::Vector2d size(width.value_or(0), height.value_or(0));
    const bool is_physical = has_unit(root, "width") || has_unit(root, "height");
    double unit = is_physical ? mm_per_pixel : mm_per_inch / options_.resolution.value_or(pixels_per_inch);
    drawing_.unit_is_known = is_physical || options_.resolution;
    if (!drawing_.unit_is_known && !options_.width && options_.unit == LengthUnit::automatic) ask_for_resolution(root);
    if (const auto wanted = millimetres_of(options_.unit)) {
      unit = *wanted;
      drawing_.unit_is_known = true;
      if (!box.empty()) {
        size = {box[2], box[3]};
        view.translation() << -box[0], -box[1];
      }
    } else if (!box.empty()) {
      const double scale = width ? *width / box[2] : height ? *height / box[3] : 1;
      size = {scale * box[2], height.value_or(scale * box[3])};
      view = view_of(root, box, size);
    }
    drawing_.has_page = !box.empty() || height;
    drawing_.unit = unit * view.linear()(0, 0);
    Map upwards = Map::Identity();
    upwards.linear() << unit, 0, 0, -unit;
    upwards.translation() << 0, unit * size.y();
    page_size_ = box.empty() ? size : Eigen::Vector2d(box[2], box[3]);
    page_size_mm_ = unit * size;
    return upwards * view;
  }

  /// Whether the side of a page is given in a unit of length rather than in pixels.
  static bool has_unit(const pugi::xml_node& root, const char* name) {
    std::string_view text = root.attribute(name).value();
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    if (text.size() < 2 || text.ends_with("px")) return text.ends_with("Q");
    for (const std::string_view unit : {"mm", "cm", "in", "pt", "pc", "Q"}) {
      if (text.ends_with(unit)) return true;
    }
    return false;
  }

  /// Throws "outline.resolution_missing" if the file is of a program whose pixels were not 1/96 inch.
  void ask_for_resolution(const pugi::xml_node& root) const {
    const std::string_view head = text_.substr(0, std::min(text_.size(), searched_head_bytes));
    const auto ask = [](const std::string& program, const std::string& pixels) {
      const std::string words = "the file is of " + program + ", and its sizes are pixels: give " + pixels +
                                " pixels per inch, or the drawing's unit or width";
      throw Error("outline.resolution_missing", "The size of the drawing is not known: " + words + ".",
                  {{"resolution", words}});
    };
    if (head.find("Adobe Illustrator") != std::string_view::npos) ask("Adobe Illustrator", "72 (its own) or 96");
    std::string_view version;
    for (const auto& attribute : root.attributes()) {
      const std::string_view name(attribute.name());
      if (name == "inkscape:version") version = attribute.value();
    }
    const auto old = take_number(version);
    if (old && *old < first_inkscape_with_96) ask("Inkscape before 0.92", "90 (that of such a version) or 96");
  }

  static std::vector<double> box_of(const pugi::xml_node& node) {
    auto box = read_numbers(node.attribute("viewBox").value());
    if (!box.empty() && (box.size() != 4 || !(box[2] > 0) || !(box[3] > 0)))
      throw std::invalid_argument("viewBox must be four numbers, of which width and height are positive");
    return box;
  }

  /// The map of a view box into a rectangle. By default, it is scaled uniformly and centred; "preserveAspectRatio" may
  /// change both.
  static Map view_of(const pugi::xml_node& node, const std::vector<double>& box, const Eigen::Vector2d& size) {
    const Eigen::Vector2d extent(box[2], box[3]);
    Eigen::Vector2d scale = size.cwiseQuotient(extent);
    std::string_view aspect = without_leading_spaces(node.attribute("preserveAspectRatio").value());
    if (aspect.starts_with("defer")) aspect = without_leading_spaces(aspect.substr(5));
    if (!aspect.starts_with("none"))
      scale.setConstant(aspect.find("slice") != std::string_view::npos ? scale.maxCoeff() : scale.minCoeff());
    // The fractions of the remaining space before the box, from words such as "xMinYMax".
    Eigen::Vector2d fraction(0.5, 0.5);
    if (aspect.size() >= 8 && aspect.front() == 'x') {
      const auto fraction_of = [](std::string_view word) { return word == "Min" ? 0 : word == "Max" ? 1 : 0.5; };
      fraction << fraction_of(aspect.substr(1, 3)), fraction_of(aspect.substr(5, 3));
    }
    Map map = Map::Identity();
    map.linear() << scale.x(), 0, 0, scale.y();
    map.translation() = (size - scale.cwiseProduct(extent)).cwiseProduct(fraction) -
                        scale.cwiseProduct(Eigen::Vector2d(box[0], box[1]));
    return map;
  }

  void check_depth(const Context& context, const pugi::xml_node& node) const {
    if (context.depth > max_nesting) check_nesting(context.depth, "groups", describe(node));
  }

  void read_children(const pugi::xml_node& parent, const Context& context) {
    check_depth(context, parent);
    const bool is_switch = local_name(parent.name()) == "switch";
    for (const pugi::xml_node& node : parent.children()) {
      if (++elements_read_ % elements_between_checks == 0) execution_.cancellation.throw_if_requested();
      if (is_copying_) count_copy(node);
      if (node.type() != pugi::node_element) continue;
      if (!is_switch) {
        read_element(node, context);
      } else if (is_chosen(node)) {
        return read_element(node, context);
      }
    }
  }

  /// Whether a browser would show this child of a <switch>: it needs no extension and no other language.
  static bool is_chosen(const pugi::xml_node& node) {
    const std::string_view language = node.attribute("systemLanguage").value();
    return !node.attribute("requiredExtensions") && (!node.attribute("systemLanguage") || language.starts_with("en")) &&
           local_name(node.name()) != "foreignObject";
  }

  /// The context within an element that may have a clip path. Refuses masks, and clip paths that are not supported.
  Context clipped(const pugi::xml_node& node, Context context) {
    if (!context.style.mask.empty() && !is_clipping_)
      refuse(describe(node) + " has a mask, which is not read: cut the shape in the drawing program");
    if (context.style.clip_path.empty()) return context;
    const std::string reference = std::exchange(context.style.clip_path, {});
    if (is_clipping_) refuse(describe(node) + " clips a clip path, which is not read");
    context.clip = read_clip(node, reference, context);
    return context;
  }

  /// The clip path that url(#id) names, in the coordinates of the element that it cuts. A reference to anything else
  /// than a clip path of the file cuts nothing.
  std::shared_ptr<const Clip> read_clip(const pugi::xml_node& node, const std::string& reference,
                                        const Context& context) {
    std::string id = reference;
    std::erase_if(id, [](char c) { return is_space(c) || c == '"' || c == '\''; });
    if (!id.starts_with("url(") || !id.ends_with(")"))
      refuse(describe(node) + " is clipped by " + in_quotes(reference) + "; only clip paths of the file are read");
    id = id.substr(4, id.size() - 5);
    const pugi::xml_node target = element_of(node, id);
    if (!target || local_name(target.name()) != "clipPath") {
      drawing_.warnings.push_back(describe(node) + " is clipped by " + in_quotes(reference) +
                                  ", which is no clip path of the file: nothing is cut.");
      return context.clip;
    }
    if (std::string_view(target.attribute("clipPathUnits").value()) == "objectBoundingBox")
      refuse(describe(target) + " is given as a part of what it clips, which is not read");
    count_copy(target);
    Context inside;
    inside.map =
        located(target, [&] { return Map(context.map * read_transform(target.attribute("transform").value())); });
    inside.style = located(target, [&] { return style_of(styles_.declared(target), Style{}); });
    if (!inside.style.clip_path.empty()) refuse(describe(target) + " is clipped itself, which is not read");
    inside.group = "clip";
    inside.viewport = context.viewport;
    inside.depth = context.depth + 1;
    RawDrawing other_drawing = std::exchange(drawing_, {});
    drawing_.curves.reserve(0);
    is_clipping_ = true;
    const bool was_copying = std::exchange(is_copying_, true);
    read_children(target, inside);
    is_copying_ = was_copying;
    is_clipping_ = false;
    auto clip = std::make_shared<Clip>();
    std::swap(other_drawing, drawing_);
    if (!other_drawing.left_out_kinds.empty())
      refuse(describe(target) + " has " + other_drawing.left_out_kinds.begin()->first + ", which cuts nothing here");
    clip->curves = std::move(other_drawing.curves);
    clip->outer = context.clip;
    clip_curves_ += clip->curves.size();
    if (clip_curves_ > max_curves) {
      const std::string limit = std::to_string(max_curves);
      throw Error("outline.too_large", "The clip paths of the drawing have more than " + limit + " curves.",
                  {{"text", "has clip paths of more than " + limit + " curves, at " + describe(target)}});
    }
    return clip;
  }

  void check_attributes(const pugi::xml_node& node) const {
    const auto attributes = node.attributes();
    if (static_cast<std::size_t>(std::distance(attributes.begin(), attributes.end())) <= max_attributes) return;
    const std::string limit = std::to_string(max_attributes);
    throw Error("outline.too_large", "An element of the drawing has more than " + limit + " attributes.",
                {{"text", "has more than " + limit + " attributes at " + describe(node)}});
  }

  void read_element(const pugi::xml_node& node, const Context& outer) {
    check_attributes(node);
    const std::string_view name = local_name(node.name());
    const bool is_group = is_one_of(name, {"g", "a", "switch", "svg"});
    const bool is_shape = is_one_of(name, {"path", "polygon", "polyline", "line", "rect", "circle", "ellipse"});
    const bool is_use = name == "use";
    const bool is_other = is_one_of(name, {"text", "image", "foreignObject"});
    if (!is_group && !is_shape && !is_use && !is_other) return;
    Declarations declared = styles_.declared(node);
    Context context{outer.map, {}, {}, outer.group, outer.clip, outer.viewport, outer.depth};
    context.style = located(node, [&] { return style_of(declared, outer.style); });
    if (!context.style.is_displayed) return leave_hidden(drawing_, describe(node), "it is hidden (display: none)");
    if (is_other) {
      if (context.style.is_visible && context.style.is_opaque)
        leave_out(drawing_, "<" + std::string(name) + ">", describe(node),
                  name == "text" ? "text has no outline until it is made a path" : "it is no shape");
      return;
    }
    context.map = located(node, [&] { return Map(outer.map * read_transform(node.attribute("transform").value())); });
    context = clipped(node, std::move(context));
    styled_lengths_ = std::move(declared);
    context.names = names_of(node, outer.names);
    if (is_group || is_use) {
      context.group = outer.group + "/" + std::to_string(node.offset_debug());
      ++context.depth;
      if (is_use) return read_use(node, context);
      if (name == "svg") context = located(node, [&] { return nested(node, context, {}); });
      return read_children(node, context);
    }
    add_shape(node, name, std::move(context));
  }

  /// Why a shape is not shown; empty if it is.
  static const char* hidden_reason(const Style& style) {
    if (!style.is_visible) return "it is invisible (visibility: hidden)";
    if (!style.is_opaque) return "it is invisible (opacity: 0)";
    return style.fills() || style.strokes() ? "" : "it is invisible: it has neither fill nor stroke";
  }

  void add_shape(const pugi::xml_node& node, std::string_view name, Context context) {
    const Style& style = context.style;
    const std::string description = describe(node);
    if (const std::string why = is_clipping_ ? (style.is_visible ? "" : "hidden") : hidden_reason(style); !why.empty())
      return leave_hidden(drawing_, description, why);
    auto curves = located(node, [&] { return shape_of(node, name, context.viewport); });
    if (curves.empty()) return;
    ++elements_;
    const bool fills = is_clipping_ || style.fills();
    for (Curve& curve : curves) {
      transform(curve, context.map);
      curve.group = context.group;
      curve.description = description;
      curve.is_filled = fills;
      curve.rule = !fills ? FillRule::evenodd : is_clipping_ ? style.clip_rule : style.fill_rule;
      curve.element = elements_;
      curve.clip = context.clip;
    }
    for (std::size_t i = 0; i + 1 < curves.size(); ++i) curves[i].names = context.names;
    curves.back().names = std::move(context.names);
    if (name == "rect" && !is_clipping_ && is_background(curves.front(), style))
      return leave_hidden(drawing_, description, "it is a white background of the whole page");
    if (!fills) drawing_.stroked += curves.size();
    for (Curve& curve : curves) add_curve(drawing_, std::move(curve), execution_);
  }

  /// Whether a rectangle is white, has no stroke, lies below everything else, and covers the page.
  bool is_background(const Curve& curve, const Style& style) const {
    if (!style.is_white || style.strokes() || !drawing_.curves.empty() || !(page_size_mm_.minCoeff() > 0)) return false;
    Eigen::AlignedBox2d box;
    box.extend(curve.begin);
    for (const Piece& piece : curve.pieces) for_each_control_point(piece, [&box](const Point& p) { box.extend(p); });
    const double slack = 1e-6 * page_size_mm_.maxCoeff();
    return box.min().maxCoeff() <= slack && (box.max() - page_size_mm_).minCoeff() >= -slack;
  }

  /// The context within an inner <svg> or <symbol>, which has its own coordinates and is clipped at its edge. `use` is
  /// the element that draws it again, or empty.
  Context nested(const pugi::xml_node& node, Context context, const pugi::xml_node& use) {
    const auto side = [&](const char* name, double whole) {
      for (const pugi::xml_node& from : {use, node}) {
        if (!from || !from.attribute(name)) continue;
        const auto value = length(from, name, context.viewport);
        if (value && !(*value > 0)) throw std::invalid_argument(std::string(name) + " must be positive");
        if (value) return *value;
      }
      return whole;
    };
    const Eigen::Vector2d size(side("width", context.viewport.x()), side("height", context.viewport.y()));
    if (local_name(node.name()) == "svg")
      context.map = context.map * Eigen::Translation2d(length_or_zero(node, "x", context.viewport),
                                                       length_or_zero(node, "y", context.viewport));
    const auto box = box_of(node);
    if (box.empty() && local_name(node.name()) == "symbol") return context;
    const bool has_size = size.minCoeff() > 0;
    if (!box.empty() && !has_size)
      throw std::invalid_argument("its view box has no space, because the page has no size");
    const std::string_view overflow = node.attribute("overflow").value();
    if (has_size && overflow != "visible" && overflow != "auto") {
      auto clip = std::make_shared<Clip>();
      Curve edge;
      edge.closed = edge.is_filled = true;
      edge.pieces = {Line{{size.x(), 0}}, Line{size}, Line{{0, size.y()}}};
      transform(edge, context.map);
      clip->curves.push_back(std::move(edge));
      clip->outer = context.clip;
      context.clip = std::move(clip);
    }
    if (!box.empty()) context.map = context.map * view_of(node, box, size);
    context.viewport = box.empty() ? size : Eigen::Vector2d(box[2], box[3]);
    return context;
  }

  /// Counts an element that is drawn again. Throws "outline.too_large".
  void count_copy(const pugi::xml_node& node) {
    check_attributes(node);
    std::size_t bytes = 0;
    std::size_t attributes = 0;
    for (const auto& attribute : node.attributes()) {
      bytes += std::string_view(attribute.value()).size();
      ++attributes;
    }
    copies_ += 1 + bytes / bytes_per_copy + attributes / attributes_per_copy;
    if (copies_ <= max_copies) return;
    const std::string limit = std::to_string(max_copies);
    throw Error(
        "outline.too_large", "The drawing draws more than " + limit + " elements, or as much text, again.",
        {{"text", "draws more than " + limit + " elements, or as much text, again by <use>, at " + describe(node)}});
  }

  /// Draws the element again to which a <use> refers. References to other files are not opened.
  void read_use(const pugi::xml_node& node, Context context) {
    check_depth(context, node);
    const pugi::xml_node target = target_of(node);
    count_copy(target ? target : node);
    const std::string_view name = local_name(target.name());
    context.map = located(node, [&] {
      return Map(context.map * Eigen::Translation2d(length_or_zero(node, "x", context.viewport),
                                                    length_or_zero(node, "y", context.viewport)));
    });
    const bool was_copying = std::exchange(is_copying_, true);
    styled_lengths_ = {};
    if (name == "symbol" || name == "svg") {
      const Declarations declared = styles_.declared(target);
      Context inside = context;
      inside.style = located(target, [&] { return style_of(declared, context.style); });
      inside = clipped(target, std::move(inside));
      inside = located(target, [&] { return nested(target, inside, node); });
      inside.names = names_of(target, context.names);
      ++inside.depth;
      if (inside.style.is_displayed)
        read_children(target, inside);
      else
        leave_hidden(drawing_, describe(target), "it is hidden (display: none)");
    } else if (target && !is_one_of(name, {"text", "image", "foreignObject"})) {
      ++context.depth;
      read_element(target, context);
    } else {
      leave_out(drawing_, target ? "<use> of <" + std::string(name) + ">" : "<use> of nothing in the file",
                describe(node));
    }
    is_copying_ = was_copying;
  }

  /// The element to which a <use> refers.
  pugi::xml_node target_of(const pugi::xml_node& use) {
    std::string_view reference;
    for (const auto& attribute : use.attributes()) {
      if (local_name(attribute.name()) == "href" && reference.empty()) reference = attribute.value();
    }
    return element_of(use, reference);
  }

  /// The first element with the id of a reference "#id"; none if there is no such element. `any` is any node of the
  /// file.
  pugi::xml_node element_of(const pugi::xml_node& any, std::string_view reference) {
    if (!reference.starts_with('#')) return {};
    if (!ids_) {
      ids_.emplace();
      struct Walker : pugi::xml_tree_walker {
        std::map<std::string_view, pugi::xml_node>& ids;
        explicit Walker(std::map<std::string_view, pugi::xml_node>& found) : ids(found) {}
        bool for_each(pugi::xml_node& node) override {
          if (const auto id = node.attribute("id")) ids.emplace(id.value(), node);
          return true;
        }
      } walker(*ids_);
      any.root().traverse(walker);
    }
    const auto found = ids_->find(std::string_view(reference.substr(1)));
    return found == ids_->end() ? pugi::xml_node() : found->second;
  }

  std::vector<Curve> shape_of(const pugi::xml_node& node, std::string_view name,
                              const Eigen::Vector2d& viewport) const {
    const auto length = [&](const pugi::xml_node& from, const char* side) {
      return this->length(from, side, viewport);
    };
    const auto length_or_zero = [&](const pugi::xml_node& from, const char* side) {
      return length(from, side).value_or(0);
    };
    if (name == "path") return read_path(node.attribute("d").value());
    if (name == "rect") return rectangle(node, viewport);
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

  std::vector<Curve> rectangle(const pugi::xml_node& node, const Eigen::Vector2d& viewport) const {
    const auto length = [&](const pugi::xml_node& from, const char* side) {
      return this->length(from, side, viewport);
    };
    const auto length_or_zero = [&](const pugi::xml_node& from, const char* side) {
      return length(from, side).value_or(0);
    };
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
    // The centres of the rounded corners, and the directions in which each of them begins and ends, in the order in
    // which SVG draws a rectangle.
    const Point centres[4] = {
        {x + width - a, y + b}, {x + width - a, y + height - b}, {x + a, y + height - b}, {x + a, y + b}};
    const Point directions[5] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    for (int k = 0; k < 4; ++k) {
      const auto corner = [&](const Point& direction) {
        return Point(centres[k] + direction.cwiseProduct(Point(a, b)));
      };
      curve.pieces.emplace_back(Line{corner(directions[k])});
      const Point end = corner(directions[k + 1]);
      if (a > 0 && b > 0) curve.pieces.emplace_back(Arc{centres[k], {a, 0}, {0, b}, (k - 1) * quarter, quarter, end});
    }
    return {curve};
  }

  std::string_view text_;
  std::vector<std::ptrdiff_t> line_ends_;
  const DrawingOptions& options_;
  const Execution& execution_;
  RawDrawing drawing_;
  std::optional<std::map<std::string_view, pugi::xml_node>> ids_;  ///< filled when an element is first looked up
  Eigen::Vector2d page_size_ = Eigen::Vector2d::Zero();            ///< in user units of the view box
  Eigen::Vector2d page_size_mm_ = Eigen::Vector2d::Zero();         ///< width and height, mm; zero if they are unknown
  StyleSheet styles_;
  Declarations styled_lengths_;  ///< styles that may set lengths of the current element
  std::size_t elements_ = 0;
  std::size_t clip_curves_ = 0;
  bool is_clipping_ = false;
  std::size_t elements_read_ = 0;
  std::size_t copies_ = 0;
  bool is_copying_ = false;
};

}  // namespace

RawDrawing read_svg(std::string_view text, const DrawingOptions& options, const Execution& execution) {
  return SvgReader(text, options, execution).read();
}

}  // namespace supple::outlines
