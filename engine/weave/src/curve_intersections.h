#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "supple/base/seeded_hash.h"
#include "supple/weave/strand_curve.h"

namespace supple::weave {

/// Collects the intersections of one curve with another one moved by `shift` (mm), each once, from pairs of pieces that
/// lie near each other. Keeps references to the curves.
class CurveIntersections {
 public:
  CurveIntersections(const StrandCurve& first, const StrandCurve& second, const Eigen::Vector2d& shift)
      : first_(first), second_(second), shift_(shift) {}

  /// Finds the intersections of piece i of the first curve with piece j of the second one by Newton's method. It starts
  /// from five points, since a line can intersect a piece twice, and from the nearest point if one piece is much longer
  /// than the other. Returns the number of new intersections. O(log pieces).
  std::size_t add_pieces(std::size_t i, std::size_t j);

  /// The intersections found until now, ascending in the first coordinate. Empties the collection.
  std::vector<Intersection> take_sorted();

 private:
  /// Interval of the curve coordinate that belongs to a piece, mm. Iterates of Newton's method may leave it by
  /// `overshoot`.
  struct Range {
    double begin, end;
    double overshoot() const;
    bool allows(double s) const { return s >= begin - overshoot() && s <= end + overshoot(); }
  };

  static double nearest_fraction(const StrandCurve& curve, const Range& range, const Eigen::Vector2d& point);
  std::optional<Intersection> newton(const Range& r1, const Range& r2, double a, double b) const;
  void add_if_new(Intersection found);
  bool is_same(const Intersection& a, const Intersection& b) const;
  bool is_known(const Intersection& found) const;
  std::uint64_t cell(double first, double second) const;

  const StrandCurve& first_;
  const StrandCurve& second_;
  Eigen::Vector2d shift_;
  std::vector<Intersection> found_;
  /// Indices into `found_` by the cells of a grid, whose sides are the tolerance within which two intersections are
  /// one. Empty while there are few intersections, which are compared one by one.
  std::unordered_multimap<std::uint64_t, std::uint32_t, SeededHash> cells_;
};

}  // namespace supple::weave
