#pragma once

#include <Eigen/Core>

#include "svg_document.h"

namespace supple::outlines {

/// The page of a drawing.
struct SvgPage {
  Map map = Map::Identity();  ///< from user units to millimetres with y upwards
  double unit = 1;            ///< millimetres of a user unit
  bool unit_is_known = true;
  bool has_page = true;                               ///< whether the file says where the origin is
  Eigen::Vector2d size = Eigen::Vector2d::Zero();     ///< in user units of the view box
  Eigen::Vector2d size_mm = Eigen::Vector2d::Zero();  ///< width and height, mm; zero if they are unknown
};

/// Throws std::invalid_argument, and "outline.resolution_missing" if the file is of a program whose pixels were not
/// 1/96 inch and nothing tells its unit.
SvgPage page_of(const SvgDocument& document, const DrawingOptions& options);

}  // namespace supple::outlines
