#pragma once

#include <optional>
#include <string>
#include <utility>

#include "measured_words.h"
#include "supple/design/measurements.h"

namespace supple::design {

/// What the request, titles and remarks say about the sense.
struct SenseHints {
  Sense requested = Sense::automatic;
  std::string x_title, y_title;
  std::string unmatched_titles;  ///< titles that cannot be assigned to columns
  std::string remarks;
  bool is_table = true;  ///< false for points, whose signs follow the contract if no sense is requested
};

struct FoundSense {
  Sense sense = Sense::tension;
  SenseSource told_by = SenseSource::nothing;
};

/// Finds the sense of a stress-strain curve, and sets the signs of its points: both positive in tension, both negative
/// in compression. A curve with strains of both signs, each by more than 5 % of the range, keeps its signs. Both signs
/// are reversed if the request says compression. Throws "design.invalid_measurement" with the place "sense" if titles
/// contradict each other, or if strain and stress have opposite signs and nothing says which one is right.
FoundSense apply_sense(MeasuredCurve& curve, const SenseHints& hints);

}  // namespace supple::design
