#pragma once

#include <optional>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// Collects the reasons why a layout cannot be printed.
class PrintFaults {
 public:
  /// `room`: the length in mm that is needed and the one that is there, if that is the fault.
  void add(const std::string& where, const std::string& message, std::optional<Error::Shortage> room = {}) {
    if (details_.size() < max_details) details_.push_back({where, message, room});
  }
  /// Throws "weave.not_printable" with all details, if there are any.
  void throw_if_any() const;

 private:
  static constexpr std::size_t max_details = 20;
  std::vector<Error::Detail> details_;
};

/// The place of a fault in an error, such as "crossings/3" or "strands/3".
std::string crossing_name(int crossing);
std::string strand_name(int strand);
/// A length in mm with four decimals and its unit.
std::string mm(double length);

/// A crossing through which a strand slides.
struct SlidingCrossing {
  int crossing = 0;
  int upper = 0;                 ///< the strand that slides
  double upper_coordinate = 0;   ///< its coordinate at the crossing, mm
  int bottom = 0;                ///< strand on which the channel stands, crossed most nearly at a right angle
  double bottom_coordinate = 0;  ///< its coordinate at the crossing, mm
  double sine = 1;               ///< sine of the angle between `upper` and `bottom`
  double min_sine = 1;           ///< smallest sine of the angles between `upper` and the other strands
  std::vector<int> below;        ///< all strands over which `upper` passes
};

/// The sliding crossings of a valid layout, by number. A crossing through which two strands slide is a fault. So is a
/// crossing of strands so nearly parallel that no lift is long enough.
std::vector<SlidingCrossing> sliding_crossings(const Weave& weave, PrintFaults& faults);

/// The strands in printing order. A lower strand comes before the strands above it, strands that slide nowhere come
/// before the others, and otherwise strands are sorted by number. If `requested` is not empty, it is the order, and
/// "weave.invalid_option" is thrown unless it names each strand once. Strands that would have to be below each other
/// are "weave.not_printable". O(crossings log strands).
std::vector<int> print_order(int strands, const std::vector<SlidingCrossing>& crossings,
                             const std::vector<int>& requested);

}  // namespace supple::weave
