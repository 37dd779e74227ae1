#pragma once

#include <string>

#include "plot_curves.h"

// What surrounds the curves of a panel.
namespace supple::cli {

/// Axes as SVG, in the order in which they are drawn: the grid, the curves within `shape`, the labels.
struct Axes {
  Frame frame;
  std::string shape;   ///< the area of the curves, an element without its end
  std::string grid;    ///< lines, and the numbers outside of the area
  std::string labels;  ///< what stands above the curves
};

/// Straight axes; the ranges are widened a little.
Axes cartesian_axes(Range x, Range y, const std::string& x_label, const std::string& y_label);

/// Angles in rad around, values outwards from 0, or from below the least one where there are negative ones.
/// `all_around`: the samples cover the half turn.
Axes polar_axes(Range values, bool all_around);

}  // namespace supple::cli
