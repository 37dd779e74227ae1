#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plot_paper.h"

// Smooth curves through samples, on any kind of paper.
namespace supple::cli {

/// How numbers become places on the paper.
struct Frame {
  std::function<Point(double, double)> place;
  bool polar = false;
  bool all_around = false;  ///< of polar curves: the samples cover the half turn
};

/// Where the samples of a curve lie on the paper, in the order of their parameter.
struct Curve {
  std::vector<double> parameter;
  std::vector<Point> points;
  bool closed = false;    ///< the first sample follows the last one
  bool straight = false;  ///< from sample to sample, without rounding
};

/// One curve; over directions a second copy half a turn away, or one closed curve. x in any order.
std::vector<Curve> curves_of(const Frame& frame, const std::vector<double>& x, const std::vector<double>& y);

/// A path through the samples, smooth unless `straight`. It begins anew after one that is missing.
std::string path_of(const Curve& curve);
/// The paths of all curves; nothing where there are no values.
std::string path_of(const Frame& frame, const std::vector<double>& x, const std::vector<double>& y);

}  // namespace supple::cli
