#pragma once

#include <string>

#include "plot_curves.h"

// The axes around the curves of a panel.
namespace supple::cli {

/// Axes as SVG. They are drawn in this order: the grid, the curves clipped to `shape`, the labels.
struct Axes {
  Frame frame;
  std::string shape;   ///< the area of the curves, as an SVG element without its closing "/>"
  std::string grid;    ///< lines, and the numbers outside of the area
  std::string labels;  ///< texts that are drawn over the curves
};

/// Straight axes, whose ranges are slightly wider than x and y.
Axes cartesian_axes(Range x, Range y, const std::string& x_label, const std::string& y_label);

/// Polar axes with angles in rad. The centre has the value 0, or one below the least value if that is negative.
/// `all_around` says that the samples cover the half turn, after which the profile repeats.
Axes polar_axes(Range values, bool all_around);

}  // namespace supple::cli
