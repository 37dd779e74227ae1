#pragma once

namespace supple::voronoi {

/// Relative to the face: shorter parts of borders count as straight, and curves are found to this.
inline constexpr double shortest_curve = 1e-9;
inline constexpr double curve_rounding = 1e-13;
/// Relative to the face: images closer than this are one.
inline constexpr double same_image = 1e-9;
/// Relative to the face: lengths that differ by less do not say which is shorter.
inline constexpr double tie_gap = 1e-12;

}  // namespace supple::voronoi
