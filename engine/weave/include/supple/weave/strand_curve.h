#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"

namespace supple::weave {

/// How a strand continues where its points end.
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
/// The construction begins with a C2 spline in the cumulated chord length, not-a-knot at open ends and periodic
/// otherwise [deBoor1978, chapter IV]. It is refined to pieces that turn by less than 0.06 rad, and the pieces'
/// parameter lengths are replaced by their arc lengths until both agree. The second derivative is piecewise linear. The
/// third derivative jumps at the ends of the pieces, by O(piece length) for a smooth curve. Any function of the
/// position and the first two derivatives is continuous.
class StrandCurve {
 public:
  /// `points` in mm: at least 2 (open), 3 (closed) or 1 (periodic, with its translation), no two neighbours closer than
  /// 1e-9 times the extent. Throws "weave.invalid_strand", with details at "points/i", and at "points" if the curve
  /// turns so often that it has more than `max_pieces` pieces. O(pieces), about 2 us for each; checks for a stop
  /// request every few thousand.
  StrandCurve(const std::vector<Eigen::Vector2d>& points, Ends ends,
              const Eigen::Vector2d& translation = Eigen::Vector2d::Zero(), const Execution& execution = {});

  /// Maximum number of pieces of a curve. A piece takes some 100 bytes.
  static constexpr std::size_t max_pieces = 4'000'000;

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
  /// The point at any s in mm. Open curves continue as straight lines beyond their ends, and others repeat. O(log
  /// pieces).
  Point at(double s) const;

  /// The coordinates where the pieces begin, and the length of the curve; mm.
  const std::vector<double>& knots() const { return knots_; }

 private:
  void fit(std::vector<Eigen::Vector2d> values, const Execution& execution);
  std::vector<std::size_t> refine(const Execution& execution);
  void bisect(std::size_t piece, double begin, double end, int max_bisections,
              std::vector<Eigen::Vector2d>& refined) const;
  void reparametrize(const Execution& execution);
  Point point_in_piece(std::size_t piece, double t) const;
  double piece_length(std::size_t piece, double from, double to) const;

  Ends ends_;
  Eigen::Vector2d translation_;
  bool straight_ = false;
  std::vector<double> knots_;
  std::vector<Eigen::Vector2d> values_;              ///< positions at the knots, mm
  std::vector<Eigen::Vector2d> second_derivatives_;  ///< at the knots, 1/mm
  std::vector<double> point_coordinates_;
};

/// Where two curves meet.
struct Intersection {
  double first = 0;   ///< arc-length coordinate on the first curve, mm
  double second = 0;  ///< arc-length coordinate on the second curve, mm
  double angle = 0;   ///< acute angle between the tangents, rad, in [0, pi / 2]
};

/// Finds all points where `first` meets `second` moved by `shift` (mm), including ends, within one period of each
/// curve. They are sorted by the first coordinate. Curves that touch without crossing may be missed. O((n + k) log n)
/// for n pieces of which k pairs lie near each other.
std::vector<Intersection> intersections(const StrandCurve& first, const StrandCurve& second,
                                        const Eigen::Vector2d& shift);

}  // namespace supple::weave
