#include <Eigen/Geometry>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <utility>

#include "svg_attributes.h"
#include "svg_document.h"
#include "svg_page.h"
#include "svg_shapes.h"
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

class SvgReader {
 public:
  SvgReader(std::string_view text, const DrawingOptions& options, const Execution& execution)
      : document_(text, execution), options_(options), execution_(execution) {}

  RawDrawing read() {
    const pugi::xml_node root = document_.root();
    read_styles();
    page_ = document_.located(root, [&] { return page_of(document_, options_); });
    drawing_.unit = page_.unit;
    drawing_.unit_is_known = page_.unit_is_known;
    drawing_.has_page = page_.has_page;
    const Style style = document_.located(root, [&] { return style_of(styles_.declared(root), Style{}); });
    Context context{page_.map, style, {}, "page", {}, page_.size, 1};
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

  void read_styles() {
    for (const pugi::xml_node& node : document_.whole().children()) {
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
    document_.whole().traverse(walker);
    for (const pugi::xml_node& node : walker.styles) {
      const std::string_view media = node.attribute("media").value();
      if (!media.empty() && media != "all" && media != "screen") continue;
      std::string text;
      for (const pugi::xml_node& child : node.children()) text += child.value();
      styles_.add(text, [&](const std::string& rule) {
        drawing_.warnings.push_back("The rule " + in_quotes(rule) + " of " + document_.describe(node) +
                                    " is not followed: it may hide or show shapes.");
      });
    }
  }

  void check_depth(const Context& context, const pugi::xml_node& node) const {
    if (context.depth > max_nesting) check_nesting(context.depth, "groups", document_.describe(node));
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
      refuse(document_.describe(node) + " has a mask, which is not read: cut the shape in the drawing program");
    if (context.style.clip_path.empty()) return context;
    const std::string reference = std::exchange(context.style.clip_path, {});
    if (is_clipping_) refuse(document_.describe(node) + " clips a clip path, which is not read");
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
      refuse(document_.describe(node) + " is clipped by " + in_quotes(reference) +
             "; only clip paths of the file are read");
    id = id.substr(4, id.size() - 5);
    const pugi::xml_node target = document_.element_of(id);
    if (!target || local_name(target.name()) != "clipPath") {
      drawing_.warnings.push_back(document_.describe(node) + " is clipped by " + in_quotes(reference) +
                                  ", which is no clip path of the file: nothing is cut.");
      return context.clip;
    }
    if (std::string_view(target.attribute("clipPathUnits").value()) == "objectBoundingBox")
      refuse(document_.describe(target) + " is given as a part of what it clips, which is not read");
    count_copy(target);
    Context inside;
    inside.map = document_.located(
        target, [&] { return Map(context.map * read_transform(target.attribute("transform").value())); });
    inside.style = document_.located(target, [&] { return style_of(styles_.declared(target), Style{}); });
    if (!inside.style.clip_path.empty()) refuse(document_.describe(target) + " is clipped itself, which is not read");
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
      refuse(document_.describe(target) + " has " + other_drawing.left_out_kinds.begin()->first +
             ", which cuts nothing here");
    clip->curves = std::move(other_drawing.curves);
    clip->outer = context.clip;
    clip_curves_ += clip->curves.size();
    if (clip_curves_ > max_curves) {
      const std::string limit = std::to_string(max_curves);
      throw Error("outline.too_large", "The clip paths of the drawing have more than " + limit + " curves.",
                  {{"text", "has clip paths of more than " + limit + " curves, at " + document_.describe(target)}});
    }
    return clip;
  }

  void check_attributes(const pugi::xml_node& node) const {
    const auto attributes = node.attributes();
    if (static_cast<std::size_t>(std::distance(attributes.begin(), attributes.end())) <= max_attributes) return;
    const std::string limit = std::to_string(max_attributes);
    throw Error("outline.too_large", "An element of the drawing has more than " + limit + " attributes.",
                {{"text", "has more than " + limit + " attributes at " + document_.describe(node)}});
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
    context.style = document_.located(node, [&] { return style_of(declared, outer.style); });
    if (!context.style.is_displayed)
      return leave_hidden(drawing_, document_.describe(node), "it is hidden (display: none)");
    if (is_other) {
      if (context.style.is_visible && context.style.is_opaque)
        leave_out(drawing_, "<" + std::string(name) + ">", document_.describe(node),
                  name == "text" ? "text has no outline until it is made a path" : "it is no shape");
      return;
    }
    context.map =
        document_.located(node, [&] { return Map(outer.map * read_transform(node.attribute("transform").value())); });
    context = clipped(node, std::move(context));
    styled_lengths_ = std::move(declared);
    context.names = names_of(node, outer.names);
    if (is_group || is_use) {
      context.group = outer.group + "/" + std::to_string(node.offset_debug());
      ++context.depth;
      if (is_use) return read_use(node, context);
      if (name == "svg") context = document_.located(node, [&] { return nested(node, context, {}); });
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
    const std::string description = document_.describe(node);
    if (const std::string why = is_clipping_ ? (style.is_visible ? "" : "hidden") : hidden_reason(style); !why.empty())
      return leave_hidden(drawing_, description, why);
    auto curves = document_.located(node, [&] { return shape_of(node, name, {styled_lengths_, context.viewport}); });
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
    if (!style.is_white || style.strokes() || !drawing_.curves.empty() || !(page_.size_mm.minCoeff() > 0)) return false;
    Eigen::AlignedBox2d box;
    box.extend(curve.begin);
    for (const Piece& piece : curve.pieces) for_each_control_point(piece, [&box](const Point& p) { box.extend(p); });
    const double slack = 1e-6 * page_.size_mm.maxCoeff();
    return box.min().maxCoeff() <= slack && (box.max() - page_.size_mm).minCoeff() >= -slack;
  }

  /// The context within an inner <svg> or <symbol>, which has its own coordinates and is clipped at its edge. `use` is
  /// the element that draws it again, or empty.
  Context nested(const pugi::xml_node& node, Context context, const pugi::xml_node& use) {
    const SvgLengths lengths{styled_lengths_, context.viewport};
    const auto side = [&](const char* name, double whole) {
      for (const pugi::xml_node& from : {use, node}) {
        if (!from || !from.attribute(name)) continue;
        const auto value = lengths.of(from, name);
        if (value && !(*value > 0)) throw std::invalid_argument(std::string(name) + " must be positive");
        if (value) return *value;
      }
      return whole;
    };
    const Eigen::Vector2d size(side("width", context.viewport.x()), side("height", context.viewport.y()));
    if (local_name(node.name()) == "svg")
      context.map = context.map * Eigen::Translation2d(lengths.or_zero(node, "x"), lengths.or_zero(node, "y"));
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
    throw Error("outline.too_large", "The drawing draws more than " + limit + " elements, or as much text, again.",
                {{"text", "draws more than " + limit + " elements, or as much text, again by <use>, at " +
                              document_.describe(node)}});
  }

  /// Draws the element again to which a <use> refers. References to other files are not opened.
  void read_use(const pugi::xml_node& node, Context context) {
    check_depth(context, node);
    const pugi::xml_node target = document_.target_of(node);
    count_copy(target ? target : node);
    const std::string_view name = local_name(target.name());
    const SvgLengths lengths{styled_lengths_, context.viewport};
    context.map = document_.located(node, [&] {
      return Map(context.map * Eigen::Translation2d(lengths.or_zero(node, "x"), lengths.or_zero(node, "y")));
    });
    const bool was_copying = std::exchange(is_copying_, true);
    styled_lengths_ = {};
    if (name == "symbol" || name == "svg") {
      const Declarations declared = styles_.declared(target);
      Context inside = context;
      inside.style = document_.located(target, [&] { return style_of(declared, context.style); });
      inside = clipped(target, std::move(inside));
      inside = document_.located(target, [&] { return nested(target, inside, node); });
      inside.names = names_of(target, context.names);
      ++inside.depth;
      if (inside.style.is_displayed)
        read_children(target, inside);
      else
        leave_hidden(drawing_, document_.describe(target), "it is hidden (display: none)");
    } else if (target && !is_one_of(name, {"text", "image", "foreignObject"})) {
      ++context.depth;
      read_element(target, context);
    } else {
      leave_out(drawing_, target ? "<use> of <" + std::string(name) + ">" : "<use> of nothing in the file",
                document_.describe(node));
    }
    is_copying_ = was_copying;
  }

  std::string_view text_;
  std::vector<std::ptrdiff_t> line_ends_;
  SvgDocument document_;
  const DrawingOptions& options_;
  const Execution& execution_;
  RawDrawing drawing_;
  SvgPage page_;
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
