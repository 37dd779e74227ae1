#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

/// Points of a curve at rest for drawing it, both ends included (of a loop the first one twice); mm.
std::vector<Eigen::Vector2d> polyline(const StrandCurve& curve, const Execution& execution = {});
/// How many points that has: about two for each millimetre of a curve.
std::size_t polyline_size(const StrandCurve& curve);

/// An SVG picture of a layout at rest: strands as lines of their width, fused crossings as dots, sliding ones as open
/// rings with a line along the strand that slides; of a cell its outline too. Millimetres are user units, y points up.
/// O(points + crossings), about 1 us for each; stops where a stop is requested.
std::string to_svg(const Weave& weave, const Execution& execution = {});

/// The same of deformed polylines (mm), seen from above.
std::string to_svg(const std::vector<std::vector<Eigen::Vector3d>>& strands, double width = 0.5);

}  // namespace supple::weave
