#include "measured_sense.h"

#include <algorithm>
#include <cmath>

#include "measured_loading.h"
#include "supple/base/error.h"
#include "supple/design/measured_text.h"

namespace supple::design {
namespace {

[[noreturn]] void refuse_sense(const std::string& why) {
  const std::string message = "must be \"tension\" or \"compression\": " + why;
  throw Error("design.invalid_measurement", "sense: " + message + ".", {{"sense", message}});
}

/// Signs of a curve as it is written: of the strain that is farthest from zero, and of the stresses there.
struct WrittenSigns {
  double x = 0, y = 0;
  bool both_ways = false;
};

WrittenSigns signs_of(const MeasuredCurve& curve) {
  double least = 0, greatest = 0;
  for (const auto& p : curve.points) {
    if (!p.allFinite()) continue;
    least = std::min(least, p.x());
    greatest = std::max(greatest, p.x());
  }
  WrittenSigns signs;
  const double range = greatest - least;
  signs.both_ways = greatest > noticeable_fraction * range && -least > noticeable_fraction * range;
  signs.x = greatest >= -least ? 1 : -1;
  // The mean over the farther half: a break's scatter about zero has no say.
  double sum = 0;
  for (const auto& p : curve.points) {
    if (p.allFinite() && signs.x * p.x() > 0.5 * std::max(greatest, -least)) sum += p.y();
  }
  signs.y = sum < 0 ? -1 : 1;
  return signs;
}

/// The sense that titles or remarks tell; automatic where they do not.
FoundSense told_sense(const SenseSources& sources) {
  if (sources.asked != Sense::automatic) return {sources.asked, SenseTold::request};
  const TitleWords x = words_of(sources.x_title), y = words_of(sources.y_title);
  // "Compression" and "traction" of the same test cannot both be right.
  if ((x.compression || y.compression) && (x.tension || y.tension))
    refuse_sense("the titles \"" + shortened(sources.x_title, 80) + "\" and \"" + shortened(sources.y_title, 80) +
                 "\" speak of both");
  if (x.compression || y.compression) return {Sense::compression, SenseTold::titles};
  if (x.tension || y.tension) return {Sense::tension, SenseTold::titles};
  const TitleWords unread = words_of(sources.unread_titles);
  if (unread.compression != unread.tension)
    return {unread.compression ? Sense::compression : Sense::tension, SenseTold::titles};
  const TitleWords remarks = words_of_remarks(sources.remarks);
  if (remarks.compression) return {Sense::compression, SenseTold::remarks};
  if (remarks.tension) return {Sense::tension, SenseTold::remarks};
  return {Sense::automatic, SenseTold::nothing};
}

void multiply(MeasuredCurve& curve, double x, double y) {
  for (auto& p : curve.points) p = Eigen::Vector2d(x * p.x(), y * p.y());
}

}  // namespace

FoundSense apply_sense(MeasuredCurve& curve, const SenseSources& sources) {
  const WrittenSigns written = signs_of(curve);
  if (!sources.is_table && sources.asked == Sense::automatic)
    return {written.both_ways ? Sense::both : written.x < 0 ? Sense::compression : Sense::tension, SenseTold::signs};
  FoundSense found = told_sense(sources);
  if (written.both_ways) {
    // The signs alone tell the two ways apart. A request says which of them is positive.
    const bool turned = found.told_by == SenseTold::request && found.sense == Sense::compression;
    if (written.x != written.y && found.told_by != SenseTold::request)
      refuse_sense("strain and stress have opposite signs");
    multiply(curve, turned ? -1 : 1, turned ? -written.x * written.y : written.x * written.y);
    return {Sense::both, found.told_by == SenseTold::request ? SenseTold::request : SenseTold::signs};
  }
  if (found.sense == Sense::automatic) {
    if (written.x != written.y)
      refuse_sense(
          "strain and stress have opposite signs, and neither the titles nor the remarks speak of tension or "
          "compression");
    if (written.x > 0) return {Sense::tension, SenseTold::nothing};
    return {Sense::compression, SenseTold::signs};
  }
  const double sign = found.sense == Sense::compression ? -1 : 1;
  // "Tensile strain" with negative numbers is strange enough to be asked about, unless the request says it.
  if (found.told_by != SenseTold::request && found.sense == Sense::tension && (written.x < 0 && written.y < 0))
    refuse_sense("the titles or remarks speak of tension, and the numbers are negative");
  multiply(curve, sign * written.x, sign * written.y);
  return found;
}

}  // namespace supple::design
