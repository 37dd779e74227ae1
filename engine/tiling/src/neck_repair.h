#pragma once

#include <polyclipping/clipper.hpp>
#include <vector>

#include "narrow_places.h"

namespace supple::tiling {

/// What is done about the necks of a solid: material that is added, and material that is taken away.
struct NeckRepair {
  ClipperLib::Paths added, removed;
  bool is_empty() const { return added.empty() && removed.empty(); }
};

/// Widens or cuts necks. A neck is a narrow place with solid on either side in which a disk of the wall's width fits:
/// eroding the solid by half the wall parts it there. Narrow places before an acute corner or a stub are none. A neck
/// is widened by a strip of the wall's width from one of these disks over the neck to the other one. Where the strip
/// would not lie within the outline, or the neck is longer than some walls, it is cut.
class NeckRepairs {
 public:
  /// The outline of the part, and the width of its smallest wall in mm, which must be positive. The outline must
  /// outlive the repairs.
  NeckRepairs(const ClipperLib::Paths& outline, double wall);

  /// Narrow places below this width (mm) are looked at. It is a bit less than the wall, so that rounding makes no
  /// necks.
  double limit() const;

  /// What to do next about the necks among these narrow places of the solid. A neck that is found again and
  /// again is cut in the end. Empty where no neck is left. O(n log n) for n corners, if there is a narrow place.
  NeckRepair next(const SolidFace& solid, const std::vector<NarrowPlace>& places);

  std::size_t widened() const;  ///< necks that were widened
  std::size_t cut() const;      ///< necks that were cut

 private:
  struct Neck {
    Eigen::Vector2d at;
    int rounds = 0, last_round = 0;  ///< in how many rounds it was found, and in which one at last
    bool is_cut = false;
  };

  const ClipperLib::Paths& outline_;
  double wall_;
  std::vector<Neck> necks_;
  int round_ = 0;
};

/// Joins the solid, by some micrometres, where two of its corners lie in one place. A neck is left there.
ClipperLib::Paths joined_corners(const ClipperLib::Paths& solid, const ClipperLib::Paths& outline);

}  // namespace supple::tiling
