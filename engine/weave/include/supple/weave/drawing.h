#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

/// The points for drawing a curve at rest, including both ends (a loop has its first point twice); mm.
std::vector<Eigen::Vector2d> polyline(const StrandCurve& curve, const Execution& execution = {});
/// The number of these points, about two for each millimetre of a curve.
std::size_t polyline_size(const StrandCurve& curve);

/// An SVG picture of a layout at rest. Strands are lines of their width, fused crossings are dots, and sliding
/// crossings are open rings with a line along the strand that slides. A cell has its outline too. Millimetres are user
/// units, and y points up. O(points + crossings), about 1 us for each. Throws if a stop is requested.
std::string to_svg(const Weave& weave, const Execution& execution = {});

/// An SVG picture of deformed polylines (mm), seen from above.
std::string to_svg(const std::vector<std::vector<Eigen::Vector3d>>& strands, double width = 0.5);

}  // namespace supple::weave
