#pragma once

#include <optional>
#include <string>
#include <utility>

#include "measured_words.h"
#include "supple/design/measurements.h"

namespace supple::design {

/// What titles and remarks say, and what the request asks for.
struct SenseSources {
  Sense asked = Sense::automatic;
  std::string x_title, y_title;
  std::string unread_titles;  ///< titles that fit no columns
  std::string remarks;
  bool is_table = true;  ///< points without a sense have the signs of the contract
};

struct FoundSense {
  Sense sense = Sense::tension;
  SenseTold told_by = SenseTold::nothing;
};

/// Finds the sense of a curve of stress over strain and gives its points the signs of it: both positive in tension,
/// both negative in compression. A curve whose strain goes both ways by more than 5 % of its range keeps its signs, or
/// has both turned where the request says compression. Throws "design.invalid_measurement" with the place "sense" where
/// titles contradict each other, or strain and stress have opposite signs and nothing tells which is right.
FoundSense apply_sense(MeasuredCurve& curve, const SenseSources& sources);

}  // namespace supple::design
