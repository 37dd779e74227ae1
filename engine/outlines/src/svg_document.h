#pragma once

#include <cstddef>
#include <initializer_list>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "reading.h"

namespace supple::outlines {

/// The name without the prefix of its namespace.
std::string_view local_name(const char* name);
bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names);
/// The names of an element, in front of those of the groups around it.
std::vector<std::string> names_of(const pugi::xml_node& node, const std::vector<std::string>& outer);
/// The view box of an element: x, y, width and height; empty if it has none. Throws std::invalid_argument.
std::vector<double> box_of(const pugi::xml_node& node);
/// The map of a view box into a rectangle. By default, it is scaled uniformly and centred; "preserveAspectRatio" may
/// change both.
Map view_of(const pugi::xml_node& node, const std::vector<double>& box, const Eigen::Vector2d& size);

/// The elements of an SVG file, and their places in it.
class SvgDocument {
 public:
  /// Refuses text that is no XML, or whose outermost element is not <svg>. `text` must outlive the document.
  SvgDocument(std::string_view text, const Execution& execution);

  pugi::xml_node root() const { return document_.document_element(); }
  pugi::xml_document& whole() { return document_; }
  std::string_view text() const { return text_; }

  /// The element and its line, for messages.
  std::string describe(const pugi::xml_node& node) const;
  /// Calls read(). If it throws, the drawing is refused with a message that names the element and its line.
  template <class Read>
  auto located(const pugi::xml_node& node, const Read& read) const -> decltype(read()) {
    try {
      return read();
    } catch (const std::invalid_argument& fault) {
      refuse(describe(node) + ": " + fault.what());
    }
  }
  /// The first element with the id of a reference "#id"; none if there is no such element.
  pugi::xml_node element_of(std::string_view reference);
  /// The element to which a <use> refers.
  pugi::xml_node target_of(const pugi::xml_node& use);

 private:
  std::size_t line_of(std::ptrdiff_t offset) const;

  std::string_view text_;
  pugi::xml_document document_;
  std::vector<std::ptrdiff_t> line_ends_;
  std::optional<std::map<std::string_view, pugi::xml_node>> ids_;  ///< filled when an element is first looked up
};

}  // namespace supple::outlines
