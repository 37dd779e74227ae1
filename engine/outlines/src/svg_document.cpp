#include "svg_document.h"

#include <algorithm>

#include "svg_attributes.h"

namespace supple::outlines {

std::string_view local_name(const char* name) {
  const std::string_view whole(name);
  const auto colon = whole.rfind(':');
  return colon == std::string_view::npos ? whole : whole.substr(colon + 1);
}

bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

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

std::vector<double> box_of(const pugi::xml_node& node) {
  auto box = read_numbers(node.attribute("viewBox").value());
  if (!box.empty() && (box.size() != 4 || !(box[2] > 0) || !(box[3] > 0)))
    throw std::invalid_argument("viewBox must be four numbers, of which width and height are positive");
  return box;
}

Map view_of(const pugi::xml_node& node, const std::vector<double>& box, const Eigen::Vector2d& size) {
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
  map.translation() =
      (size - scale.cwiseProduct(extent)).cwiseProduct(fraction) - scale.cwiseProduct(Eigen::Vector2d(box[0], box[1]));
  return map;
}

SvgDocument::SvgDocument(std::string_view text, const Execution& execution) : text_(text) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] == '\n') line_ends_.push_back(static_cast<std::ptrdiff_t>(k));
  }
  // Entities other than XML's own stay as they are written, and a document type is skipped.
  const auto result = document_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  execution.cancellation.throw_if_requested();
  if (!result)
    refuse("line " + std::to_string(line_of(std::max<std::ptrdiff_t>(result.offset, 0))) + ": " + result.description());
  if (local_name(root().name()) != "svg") refuse("the element " + in_quotes(root().name()) + " is no <svg>");
}

std::size_t SvgDocument::line_of(std::ptrdiff_t offset) const {
  return 1 +
         static_cast<std::size_t>(std::lower_bound(line_ends_.begin(), line_ends_.end(), offset) - line_ends_.begin());
}

std::string SvgDocument::describe(const pugi::xml_node& node) const {
  const std::string_view id = node.attribute("id").value();
  return "<" + shortened(local_name(node.name())) + ">" + (id.empty() ? "" : " " + in_quotes(id)) + " of line " +
         std::to_string(line_of(node.offset_debug()));
}

pugi::xml_node SvgDocument::target_of(const pugi::xml_node& use) {
  std::string_view reference;
  for (const auto& attribute : use.attributes()) {
    if (local_name(attribute.name()) == "href" && reference.empty()) reference = attribute.value();
  }
  return element_of(reference);
}

pugi::xml_node SvgDocument::element_of(std::string_view reference) {
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
    document_.traverse(walker);
  }
  const auto found = ids_->find(std::string_view(reference.substr(1)));
  return found == ids_->end() ? pugi::xml_node() : found->second;
}

}  // namespace supple::outlines
