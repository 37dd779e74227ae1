#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plot_paper.h"

// Smooth curves through samples, for straight and for polar axes.
namespace supple::cli {

/// The map from numbers to positions in the picture.
struct Frame {
  std::function<Point(double, double)> place;
  bool polar = false;
  bool all_around = false;  ///< whether the samples of polar curves cover the half turn, after which they repeat
};

/// The positions of a curve's samples in the picture, in the order of their parameter.
struct Curve {
  std::vector<double> parameter;
  std::vector<Point> points;
  bool closed = false;    ///< the first sample follows the last one
  bool straight = false;  ///< whether straight segments connect the samples
};

/// The curves of y over x, which may be in any order. On polar axes there are two, half a turn apart, or one closed
/// curve if the samples are all around.
std::vector<Curve> curves_of(const Frame& frame, const std::vector<double>& x, const std::vector<double>& y);

/// An SVG path through the samples, smooth unless `straight`. It has a gap at a missing sample.
std::string path_of(const Curve& curve);
/// The SVG path of all curves; empty if there are no values.
std::string path_of(const Frame& frame, const std::vector<double>& x, const std::vector<double>& y);

}  // namespace supple::cli
