#include "measured_sense.h"

#include <algorithm>
#include <cmath>

#include "measured_loading.h"
#include "supple/design/design_fault.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

[[noreturn]] void refuse_sense(const std::string& why) {
  const std::string message = "must be \"tension\" or \"compression\": " + why;
  throw MeasurementFault("design.invalid_measurement", "sense: " + message + ".", {{"sense", message}});
}

/// Signs of a curve as it is written: of the strain with the greatest magnitude, and of the stresses near it.
struct WrittenSigns {
  double x = 0, y = 0;
  bool has_both_signs = false;
};

WrittenSigns signs_of(const MeasuredCurve& curve) {
  double min_strain = 0, max_strain = 0;
  for (const auto& p : curve.points) {
    if (!p.allFinite()) continue;
    min_strain = std::min(min_strain, p.x());
    max_strain = std::max(max_strain, p.x());
  }
  WrittenSigns signs;
  const double range = max_strain - min_strain;
  signs.has_both_signs = max_strain > noticeable_fraction * range && -min_strain > noticeable_fraction * range;
  signs.x = max_strain >= -min_strain ? 1 : -1;
  // The mean over the half with the larger strains, because after a rupture stresses scatter about zero.
  double sum = 0;
  for (const auto& p : curve.points) {
    if (p.allFinite() && signs.x * p.x() > 0.5 * std::max(max_strain, -min_strain)) sum += p.y();
  }
  signs.y = sum < 0 ? -1 : 1;
  return signs;
}

/// The sense according to the request, the titles or the remarks; automatic if none of them says it.
FoundSense stated_sense(const SenseHints& hints) {
  if (hints.requested != Sense::automatic) return {hints.requested, SenseSource::request};
  const TitleWords x = words_of(hints.x_title), y = words_of(hints.y_title);
  // Titles that name both tension and compression contradict each other.
  if ((x.compression || y.compression) && (x.tension || y.tension))
    refuse_sense("the titles \"" + shortened(hints.x_title, 80) + "\" and \"" + shortened(hints.y_title, 80) +
                 "\" speak of both");
  if (x.compression || y.compression) return {Sense::compression, SenseSource::titles};
  if (x.tension || y.tension) return {Sense::tension, SenseSource::titles};
  const TitleWords unmatched = words_of(hints.unmatched_titles);
  if (unmatched.compression != unmatched.tension)
    return {unmatched.compression ? Sense::compression : Sense::tension, SenseSource::titles};
  const TitleWords remarks = words_of_remarks(hints.remarks);
  if (remarks.compression) return {Sense::compression, SenseSource::remarks};
  if (remarks.tension) return {Sense::tension, SenseSource::remarks};
  return {Sense::automatic, SenseSource::nothing};
}

void multiply(MeasuredCurve& curve, double x, double y) {
  for (auto& p : curve.points) p = Eigen::Vector2d(x * p.x(), y * p.y());
}

}  // namespace

FoundSense apply_sense(MeasuredCurve& curve, const SenseHints& hints) {
  const WrittenSigns written = signs_of(curve);
  if (!hints.is_table && hints.requested == Sense::automatic)
    return {written.has_both_signs ? Sense::both
            : written.x < 0        ? Sense::compression
                                   : Sense::tension,
            SenseSource::signs};
  FoundSense found = stated_sense(hints);
  if (written.has_both_signs) {
    // Only the signs separate tension from compression. A request says which of them is positive.
    const bool is_reversed = found.told_by == SenseSource::request && found.sense == Sense::compression;
    if (written.x != written.y && found.told_by != SenseSource::request)
      refuse_sense("strain and stress have opposite signs");
    multiply(curve, is_reversed ? -1 : 1, is_reversed ? -written.x * written.y : written.x * written.y);
    return {Sense::both, found.told_by == SenseSource::request ? SenseSource::request : SenseSource::signs};
  }
  if (found.sense == Sense::automatic) {
    if (written.x != written.y)
      refuse_sense(
          "strain and stress have opposite signs, and neither the titles nor the remarks speak of tension or "
          "compression");
    if (written.x > 0) return {Sense::tension, SenseSource::nothing};
    return {Sense::compression, SenseSource::signs};
  }
  const double sign = found.sense == Sense::compression ? -1 : 1;
  // Negative numbers under the title "tensile strain" contradict it, unless the request says that it is tension.
  if (found.told_by != SenseSource::request && found.sense == Sense::tension && (written.x < 0 && written.y < 0))
    refuse_sense("the titles or remarks speak of tension, and the numbers are negative");
  multiply(curve, sign * written.x, sign * written.y);
  return found;
}

}  // namespace supple::design
