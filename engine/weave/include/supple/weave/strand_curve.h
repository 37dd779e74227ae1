#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"

namespace supple::weave {

/// How a strand goes on where its points end.
enum class Ends {
  open,      ///< it ends there
  closed,    ///< a loop: the last point is followed by the first
  periodic,  ///< the last point is followed by the first one moved by a translation, and so on for ever
};
std::string_view to_string(Ends ends);

/// A planar cubic spline through given points. It is twice continuously differentiable everywhere: closed and periodic
/// curves have no seam. Its parameter is the arc length to a few parts in 10^6 if the points sample a smooth curve
/// evenly, and to a few parts in 10^4 if their distances vary tenfold.
///
/// A C2 spline in the cumulated chord length (not-a-knot at open ends, periodic otherwise; de Boor 1978, chapter IV) is
/// refined to pieces that turn by less than 0.06 rad, and the pieces' parameter lengths are replaced by their arc
/// lengths until these agree. The second derivative is piecewise linear. The third derivative jumps at the ends of the
/// pieces, by O(piece length) for a smooth curve. What depends on positions and two derivatives only is continuous.
class StrandCurve {
 public:
  /// `points` in mm: at least 2 (open), 3 (closed) or 1 (periodic, with its translation), no two neighbours closer than
  /// 1e-9 times the extent. Throws "weave.invalid_strand", details at "points/i", and at "points" where the curve turns
  /// so often that it has more than `most_pieces` pieces. O(pieces), about 2 us for each; looks for a stop request
  /// every few thousand.
  StrandCurve(const std::vector<Eigen::Vector2d>& points, Ends ends,
              const Eigen::Vector2d& translation = Eigen::Vector2d::Zero(), const Execution& execution = {});

  /// How many pieces a curve has at most. A piece takes some 100 bytes.
  static constexpr std::size_t most_pieces = 4'000'000;

  /// The same curve with all lengths multiplied by a positive factor. O(pieces).
  StrandCurve scaled(double factor) const;

  double length() const { return knots_.back(); }  ///< length of the curve, or of one loop or period, mm
  Ends ends() const { return ends_; }
  const Eigen::Vector2d& translation() const { return translation_; }
  bool straight() const { return straight_; }

  /// The arc-length coordinates of the given points, ascending from 0; mm.
  const std::vector<double>& point_coordinates() const { return point_coordinates_; }

  /// A position and its derivatives with respect to s, in mm, 1, 1/mm and 1/mm^2.
  struct Point {
    Eigen::Vector2d position;
    Eigen::Vector2d first;
    Eigen::Vector2d second;
    Eigen::Vector2d third;  ///< third derivative of the piece that begins at s
  };
  /// The point at any s in mm. Beyond their ends open curves go on as straight lines, and others repeat. O(log pieces).
  Point at(double s) const;

  /// The coordinates where the pieces begin, and the length of the curve; mm.
  const std::vector<double>& knots() const { return knots_; }

 private:
  void fit(std::vector<Eigen::Vector2d> values, const Execution& execution);
  std::vector<std::size_t> refine(const Execution& execution);
  void divide(std::size_t piece, double begin, double end, int halvings, std::vector<Eigen::Vector2d>& refined) const;
  void measure(const Execution& execution);
  Point in_piece(std::size_t piece, double t) const;
  double piece_length(std::size_t piece, double from, double to) const;

  Ends ends_;
  Eigen::Vector2d translation_;
  bool straight_ = false;
  std::vector<double> knots_;
  std::vector<Eigen::Vector2d> values_;   ///< at the knots
  std::vector<Eigen::Vector2d> seconds_;  ///< second derivatives at the knots
  std::vector<double> point_coordinates_;
};

/// Where two curves meet.
struct Intersection {
  double first = 0;   ///< arc-length coordinate on the first curve, mm
  double second = 0;  ///< on the second
  double angle = 0;   ///< between the tangents' lines, rad, in [0, pi / 2]
};

/// Finds all points where `first` meets `second` moved by `shift` (mm), including ends, within one period of either.
/// They are sorted by the first coordinate. Curves that touch without crossing may be missed. O((n + k) log n) for n
/// pieces of which k pairs lie near each other.
std::vector<Intersection> intersections(const StrandCurve& first, const StrandCurve& second,
                                        const Eigen::Vector2d& shift);

}  // namespace supple::weave
