#pragma once

namespace supple::voronoi {

/// Lengths relative to the face: parts of borders shorter than min_curve_length count as straight, and points of curves
/// are found to curve_rounding.
inline constexpr double min_curve_length = 1e-9;
inline constexpr double curve_rounding = 1e-13;
/// Relative to the face: images closer than this coincide.
inline constexpr double same_image = 1e-9;
/// Relative to the face: paths whose lengths differ by less count as equally long.
inline constexpr double tie_gap = 1e-12;

}  // namespace supple::voronoi
