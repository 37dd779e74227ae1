#pragma once

#include <string>
#include <vector>

#include "supple/design/material_bound.h"
#include "supple/design/verdict.h"

namespace supple::json {

/// More ranges than these are summed up in a sentence.
inline constexpr std::size_t max_ranges_in_words = 4;
/// The widest range of directions that has its middle in words, degrees.
inline constexpr double max_degrees_around = 40;

/// A verdict in the words of api/verdicts.json: the source and the deviation, then the ranges of the worst target that
/// are reached and those that are not, for example "Simulated: 45 % off. The plateau is reached from 8 to 20 %, the
/// rise is missed from 0 to 8 % (62 % off)."
std::string verdict_sentence(const design::Verdict& verdict);

/// The targets of a design, their weights, and the nearest that any material comes to them at rest.
struct BoundedTargets {
  std::vector<design::SampledTarget> targets;
  std::vector<double> weights;
  design::MaterialBounds bounds;
};

/// What no material can have at rest of the targets that the design misses, in the words of api/verdicts.json, for
/// example "No material at rest comes nearer than 7 % to it." Empty if some material reaches them, and where the design
/// comes nearer, as it may with strain.
std::string bound_sentence(const design::Verdict& verdict, const BoundedTargets& bounded);

}  // namespace supple::json
