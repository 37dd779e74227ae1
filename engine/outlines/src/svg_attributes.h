#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reading.h"

namespace supple::outlines {

/// The map of a transform list: "matrix", "translate", "scale", "rotate", "skewX" and "skewY", the last of which is
/// applied first. Throws std::invalid_argument that says what is wrong with the list.
Map read_transform(std::string_view text);

/// A length in user units: a number without a unit or in px, mm, cm, in, pt, pc or Q. None for a percentage. Throws
/// std::invalid_argument.
std::optional<double> read_length(std::string_view text);

/// The numbers of a list, separated by blanks and commas. Throws std::invalid_argument.
std::vector<double> read_numbers(std::string_view text);

/// The subpaths of path data, the attribute "d" of a path. Throws std::invalid_argument.
std::vector<Curve> read_path(std::string_view text);

/// A whole ellipse, which begins at its rightmost point.
Curve ellipse(const Point& centre, double rx, double ry);

}  // namespace supple::outlines
