#pragma once

#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// Collects what keeps a layout from being printed.
class PrintFaults {
 public:
  void add(const std::string& where, const std::string& message) {
    if (details_.size() < most_details) details_.push_back({where, message});
  }
  /// "weave.not_printable" with all details.
  void throw_if_any() const;

 private:
  static constexpr std::size_t most_details = 20;
  std::vector<Error::Detail> details_;
};

/// "crossings/3"
std::string crossing_name(int crossing);
std::string strand_name(int strand);
/// A length with four decimals and its unit.
std::string mm(double length);

/// A crossing through which a strand slides.
struct SlidingCrossing {
  int crossing = 0;
  int upper = 0;           ///< the strand that slides
  double upper_at = 0;     ///< its coordinate, mm
  int bottom = 0;          ///< the strand that the channel stands on: what the upper one crosses most squarely
  double bottom_at = 0;    ///< mm
  double sine = 1;         ///< of the angle between these two
  double least_sine = 1;   ///< of the angles between the upper one and all others
  std::vector<int> below;  ///< all strands that the upper one passes over
};

/// Those of a valid layout, by number. Two strands that slide through one crossing, and two strands so nearly parallel
/// that no lift is long enough, are faults.
std::vector<SlidingCrossing> sliding_crossings(const Weave& weave, PrintFaults& faults);

/// The strands in printing order: the lower one of two before the upper one; what slides nowhere first; else by number,
/// or as `requested` where that is not empty ("weave.invalid_option" unless it names each strand once). Strands that
/// would have to be below each other are "weave.not_printable". O(crossings log strands).
std::vector<int> print_order(int strands, const std::vector<SlidingCrossing>& crossings,
                             const std::vector<int>& requested);

}  // namespace supple::weave
