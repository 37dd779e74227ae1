#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "supple/design/target.h"

namespace supple::design {

/// Largest relative deviation of a target that counts as reached as a whole.
inline constexpr double max_reached_deviation = 0.05;

/// Whether a target counts as reached as a whole: its relative deviation is at most `max_reached_deviation`, or each
/// sample that has weight is reached. `values` has one entry for each sample, NaN where there is no value.
bool is_reached_as_a_whole(const SampledTarget& target, const Eigen::VectorXd& values);

/// How well a range of a target is met, from best to worst.
enum class Fit {
  reached,  ///< each sample that has weight is within its tolerance, as SampledTarget::reached
  near,     ///< no sample is, and each one is within `max_reached_deviation` of the target's scale beyond its band
  missed,   ///< each sample is further off
  missing,  ///< there is no value
};
std::string_view to_string(Fit fit);

/// What a range of a target's curve looks like. Over strain it is seen from rest outwards, in tension as in
/// compression.
enum class CurvePart {
  whole,        ///< the whole curve
  compression,  ///< all strains below 0 of a curve that has others too
  tension,      ///< all strains above 0 of a curve that has others too
  around_rest,  ///< strains below and above 0, or rest alone, where a target with a preload is missed
  beginning,    ///< from rest, and less steep than later parts
  rise,         ///< from rest
  plateau,      ///< much less steep than what comes before
  stiffening,   ///< steeper than what comes before
  drop,         ///< stress decreases away from rest
  middle,       ///< none of these, before the end
  end,          ///< none of these, up to the end
  directions,   ///< a range of directions
};
std::string_view to_string(CurvePart part);

/// A range of a target over which it is met equally well.
struct FitRange {
  double from = 0;  ///< strain or rad, as the target's x
  double to = 0;
  std::size_t first = 0;  ///< index of the first sample
  std::size_t last = 0;   ///< index of the last sample
  Fit fit = Fit::missed;
  CurvePart part = CurvePart::whole;
  /// Weighted root mean square of the deviations beyond the bands over the target's scale; none if a value is missing.
  std::optional<double> deviation;
  double weight = 0;  ///< sum of the weights of its samples
  bool is_reached() const { return fit == Fit::reached; }
};

/// Divides a target into ranges of the same fit. They are contiguous and cover the target; over directions they cover
/// half a turn from the first sample. Two ranges meet halfway between their samples. A sample near rest (up to 5 % of
/// the largest strain) whose target is within the tolerance of 0 is reached by each design with little stress: it
/// belongs to the worse of the ranges beside it, which meet there. A sample without weight belongs to the range of the
/// nearest one that has weight. `values` has one entry for each sample of the target, NaN where there is no value.
/// O(samples).
std::vector<FitRange> fit_ranges(const SampledTarget& target, const Eigen::VectorXd& values);

/// The same ranges as a person sees them: over directions the last and the first are one if they have the same fit,
/// since directions repeat. Such a range begins below the first direction.
std::vector<FitRange> joined_across_period(std::vector<FitRange> ranges, Task task);

/// What the range of samples from `first` to `last` looks like in the target. O(samples).
CurvePart part_of(const SampledTarget& target, std::size_t first, std::size_t last);

}  // namespace supple::design
