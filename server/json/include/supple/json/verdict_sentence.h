#pragma once

#include <string>

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

}  // namespace supple::json
