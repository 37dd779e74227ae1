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

/// Gathers the points where one curve meets another one moved by `shift` (mm), each once, from pairs of pieces that lie
/// near each other. Keeps references to the curves.
class CurveMeetings {
 public:
  CurveMeetings(const StrandCurve& first, const StrandCurve& second, const Eigen::Vector2d& shift)
      : first_(first), second_(second), shift_(shift) {}

  /// Looks for meetings of the first curve's piece i with the second one's piece j by Newton's method from five places,
  /// since a line can cut a piece twice, and from the nearest one where one piece is much longer. Returns how many new
  /// ones were found. O(log pieces).
  std::size_t add_pieces(std::size_t i, std::size_t j);

  /// Those found until now, ascending in the first coordinate. Leaves none.
  std::vector<Intersection> take_sorted();

 private:
  struct Range {
    double begin, end;
    double slack() const;
    bool near(double s) const { return s >= begin - slack() && s <= end + slack(); }
  };

  static double nearest(const StrandCurve& curve, const Range& range, const Eigen::Vector2d& point);
  std::optional<Intersection> newton(const Range& r1, const Range& r2, double a, double b) const;
  void keep(Intersection found);
  bool same(const Intersection& a, const Intersection& b) const;
  bool known(const Intersection& found) const;
  std::uint64_t cell(double first, double second) const;

  const StrandCurve& first_;
  const StrandCurve& second_;
  Eigen::Vector2d shift_;
  std::vector<Intersection> found_;
  /// Those found by the cells of a grid whose sides are the distance of two that are one; empty while they are few.
  std::unordered_multimap<std::uint64_t, std::uint32_t, SeededHash> cells_;
};

}  // namespace supple::weave
