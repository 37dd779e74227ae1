#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

#include "svg_document.h"
#include "svg_style.h"

namespace supple::outlines {

/// Reads lengths of elements, in user units.
struct SvgLengths {
  const Declarations& styled;  ///< styles that may set lengths of the current element
  Eigen::Vector2d viewport;    ///< the lengths that are 100 %; zero if they are unknown

  /// A length of an element; none for "auto" or if the element has none. Throws std::invalid_argument.
  std::optional<double> of(const pugi::xml_node& node, const char* name) const;
  double or_zero(const pugi::xml_node& node, const char* name) const { return of(node, name).value_or(0); }
};

/// The curves of a shape of this element name, in its own coordinates; empty if it has no extent. Throws
/// std::invalid_argument.
std::vector<Curve> shape_of(const pugi::xml_node& node, std::string_view name, const SvgLengths& lengths);

}  // namespace supple::outlines
