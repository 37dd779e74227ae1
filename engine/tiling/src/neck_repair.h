#pragma once

#include <polyclipping/clipper.hpp>
#include <vector>

#include "narrow_places.h"

namespace supple::tiling {

/// A repair of necks of a solid: material that is added, and material that is removed.
struct NeckRepair {
  ClipperLib::Paths added, removed;
  bool is_empty() const { return added.empty() && removed.empty(); }
};

/// Widens or cuts necks. A neck is a narrow place with solid on either side in which a disk of the wall's width fits:
/// eroding the solid by half the wall separates it there. Narrow places before an acute corner or a stub are no necks.
/// A neck is widened by a strip of the wall's width from one of these disks over the neck to the other one. If the
/// strip would not lie within the outline, or the neck is longer than some walls, the neck is cut.
class NeckRepairs {
 public:
  /// `outline` is that of the part, and must outlive the repairs. `wall` is the width of its smallest wall, mm; it must
  /// be positive.
  NeckRepairs(const ClipperLib::Paths& outline, double wall);

  /// The width (mm) below which narrow places are considered. It is a bit less than the wall, so that rounding makes no
  /// necks.
  double limit() const;

  /// The next repair of the necks among these narrow places of the solid; empty if no neck is left. A neck that is
  /// found repeatedly is cut in the end. O(n log n) for n corners, if there is a narrow place.
  NeckRepair next(const SolidFace& solid, const std::vector<NarrowPlace>& places);

  std::size_t widened() const;  ///< necks that were widened
  std::size_t cut() const;      ///< necks that were cut

 private:
  struct Neck {
    Eigen::Vector2d position;
    int passes = 0, last_pass = 0;  ///< number of passes in which it was found, and the last of them
    bool is_cut = false;
  };

  const ClipperLib::Paths& outline_;
  double wall_;
  std::vector<Neck> necks_;
  int pass_ = 0;
};

/// Joins coincident corners of the solid by some micrometres of material. Each becomes a neck.
ClipperLib::Paths joined_corners(const ClipperLib::Paths& solid, const ClipperLib::Paths& outline);

}  // namespace supple::tiling
