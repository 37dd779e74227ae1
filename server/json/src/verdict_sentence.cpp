#include "supple/json/verdict_sentence.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "supple/base/number_text.h"
#include "verdict_words.h"

namespace supple::json {
namespace {

using design::CurvePart;
using design::Doubt;
using design::Fit;
using design::FitRange;
using design::Grade;

constexpr int significant_digits = 2;
/// With two, 145 degrees would be 150.
constexpr int direction_digits = 3;
/// Digits that tell the ends of a range apart are enough if they are as many.
constexpr int max_significant_digits = 6;
/// Percentages and degrees of a smaller magnitude are 0, which samples near rest miss by rounding.
constexpr double min_magnitude = 1e-4;
/// A smaller deviation has no number in words, %.
constexpr double min_deviation_in_words = 0.05;

/// The value of one slot of a template.
struct Slot {
  std::string_view name;
  std::string value;
};

/// The template with its slots filled in: each {name} becomes the value of that name.
std::string with_slots(std::string_view words, std::initializer_list<Slot> slots) {
  std::string text(words);
  for (const auto& [name, value] : slots) {
    const std::string slot = "{" + std::string(name) + "}";
    for (auto at = text.find(slot); at != std::string::npos; at = text.find(slot, at + value.size()))
      text.replace(at, slot.size(), value);
  }
  return text;
}

/// Rounds to significant digits; half is rounded away from zero.
double rounded(double value, int digits) {
  if (std::abs(value) < min_magnitude) return 0;
  const int exponent = digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  const double power = std::pow(10.0, std::abs(exponent));
  return exponent >= 0 ? std::round(value * power) / power : std::round(value / power) * power;
}

std::string percentage(double deviation) {
  const double percent = 100 * deviation;
  if (percent < min_deviation_in_words) return std::string(verdict_words("percent.tiny"));
  return with_slots(verdict_words("percent.value"), {{"value", number_text(rounded(percent, significant_digits))}});
}

std::string_view part_words(CurvePart part) {
  switch (part) {
    case CurvePart::whole:
      return verdict_words("part.whole");
    case CurvePart::compression:
      return verdict_words("part.compression");
    case CurvePart::tension:
      return verdict_words("part.tension");
    case CurvePart::around_rest:
      return verdict_words("part.around_rest");
    case CurvePart::beginning:
      return verdict_words("part.beginning");
    case CurvePart::rise:
      return verdict_words("part.rise");
    case CurvePart::plateau:
      return verdict_words("part.plateau");
    case CurvePart::stiffening:
      return verdict_words("part.stiffening");
    case CurvePart::drop:
      return verdict_words("part.drop");
    case CurvePart::middle:
      return verdict_words("part.middle");
    case CurvePart::end:
      return verdict_words("part.end");
    case CurvePart::directions:
      return verdict_words("part.directions");
  }
  return {};
}

std::string_view range_words(Fit fit) {
  switch (fit) {
    case Fit::reached:
      return verdict_words("range.reached");
    case Fit::near:
      return verdict_words("range.near");
    case Fit::missed:
      return verdict_words("range.missed");
    case Fit::missing:
      return verdict_words("range.missing");
  }
  return {};
}

/// Whether a range is so narrow that its middle says where it is.
bool is_around_a_direction(const FitRange& range) {
  return range.part == CurvePart::directions && (range.to - range.from) * 180 / std::numbers::pi <= max_degrees_around;
}

/// The ends of a range in percent or degrees, without the unit, with the digits that tell them apart. `follows_around`:
/// whether the range before it in the same clause is around a direction.
std::string bare_place_of(const FitRange& range, bool follows_around) {
  const bool directions = range.part == CurvePart::directions;
  const double unit = directions ? 180 / std::numbers::pi : 100;
  const double from = unit * range.from;
  const double to = unit * range.to;
  if (is_around_a_direction(range)) {
    double middle = rounded(std::fmod((from + to) / 2 + 180, 180), direction_digits);
    if (middle >= 180) middle = 0;
    return with_slots(follows_around ? verdict_words("place.next_around") : verdict_words("place.around"),
                      {{"middle", number_text(middle)}});
  }
  int digits = directions ? direction_digits : significant_digits;
  while (digits < max_significant_digits && rounded(from, digits) == rounded(to, digits)) ++digits;
  return with_slots(verdict_words("place.range"),
                    {{"from", number_text(rounded(from, digits))}, {"to", number_text(rounded(to, digits))}});
}

/// Where ranges of one part are.
std::string place_of(std::span<const FitRange> ranges) {
  std::string places;
  bool follows_around = false;
  for (const FitRange& range : ranges) {
    const std::string next = bare_place_of(range, follows_around);
    places = places.empty() ? next : with_slots(verdict_words("place.several"), {{"before", places}, {"next", next}});
    follows_around = is_around_a_direction(range);
  }
  const bool directions = ranges.front().part == CurvePart::directions;
  return with_slots(directions ? verdict_words("place.in_degrees") : verdict_words("place.in_percent"),
                    {{"places", places}});
}

std::string deviation_words(const std::optional<double>& deviation) { return deviation ? percentage(*deviation) : ""; }

/// The weighted root mean square of the deviations of ranges; none if a value is missing.
std::optional<double> deviation_of(std::span<const FitRange> ranges) {
  if (ranges.size() == 1) return ranges.front().deviation;
  double squares = 0;
  double weights = 0;
  for (const FitRange& range : ranges) {
    if (!range.deviation) return {};
    squares += range.weight * *range.deviation * *range.deviation;
    weights += range.weight;
  }
  return weights > 0 ? std::sqrt(squares / weights) : 0;
}

/// A clause about ranges of the same part that are met equally well.
std::string clause_about(std::span<const FitRange> ranges) {
  return with_slots(range_words(ranges.front().fit), {{"part", std::string(part_words(ranges.front().part))},
                                                      {"place", place_of(ranges)},
                                                      {"deviation", deviation_words(deviation_of(ranges))}});
}

/// One sentence with a clause for the ranges of each part that are met equally well, the best first.
std::string sentence_about(const std::vector<FitRange>& ranges) {
  std::vector<std::vector<FitRange>> clauses;
  for (const FitRange& range : ranges) {
    const auto same = std::find_if(clauses.begin(), clauses.end(), [&range](const std::vector<FitRange>& others) {
      return others.front().fit == range.fit && others.front().part == range.part;
    });
    if (same == clauses.end())
      clauses.push_back({range});
    else
      same->push_back(range);
  }
  std::stable_sort(clauses.begin(), clauses.end(), [](const std::vector<FitRange>& a, const std::vector<FitRange>& b) {
    return a.front().fit < b.front().fit;
  });
  std::string sentence;
  for (const auto& clause : clauses) sentence += (sentence.empty() ? "" : ", ") + clause_about(clause);
  if (sentence[0] >= 'a' && sentence[0] <= 'z') sentence[0] = static_cast<char>(sentence[0] - 'a' + 'A');
  return sentence + ".";
}

/// A sentence about the ranges of a target; empty if its deviation says everything.
std::string sentence_about(const design::TargetVerdict& target) {
  const auto ranges = joined_across_period(target.ranges, target.task);
  const bool is_missed =
      std::any_of(ranges.begin(), ranges.end(), [](const FitRange& range) { return range.fit >= Fit::missed; });
  if (!is_missed) return {};
  if (ranges.size() == 1) {
    const bool has_values = ranges.front().fit == Fit::missed;
    return has_values ? std::string(verdict_words("further.nothing_reached")) : std::string();
  }
  if (ranges.size() <= max_ranges_in_words) return sentence_about(ranges);
  const auto worst = std::max_element(ranges.begin(), ranges.end(), [](const FitRange& a, const FitRange& b) {
    return a.deviation.value_or(0) < b.deviation.value_or(0);
  });
  return with_slots(verdict_words("further.many_ranges"), {{"reached", std::to_string(target.reached)},
                                                           {"samples", std::to_string(target.samples)},
                                                           {"place", place_of({&*worst, 1})},
                                                           {"deviation", deviation_words(worst->deviation)}});
}

bool has_values(const design::Verdict& verdict) {
  return std::any_of(verdict.targets.begin(), verdict.targets.end(), [](const design::TargetVerdict& target) {
    return std::any_of(target.ranges.begin(), target.ranges.end(),
                       [](const FitRange& range) { return range.fit != Fit::missing; });
  });
}

std::string_view heading_words(const design::Verdict& verdict) {
  switch (verdict.doubt) {
    case Doubt::untrusted:
      return verdict_words("heading.untrusted");
    case Doubt::incomplete:
      return has_values(verdict) ? verdict_words("heading.incomplete") : verdict_words("heading.nothing");
    case Doubt::no_structure:
      return verdict_words("heading.no_structure");
    case Doubt::none:
      break;
  }
  switch (verdict.grade) {
    case Grade::reached:
      // Poisson's ratios near 0 are reached although they are far off relative to the target.
      return verdict.deviation.value_or(0) <= design::max_reached_deviation ? verdict_words("heading.reached")
                                                                            : verdict_words("heading.reached_within");
    case Grade::close:
      return verdict_words("heading.close");
    default:
      return verdict_words("heading.missed");
  }
}

std::string heading(const design::Verdict& verdict) {
  const bool simulated = verdict.source == design::VerdictSource::simulation;
  return with_slots(
      heading_words(verdict),
      {{"source", std::string(simulated ? verdict_words("source.simulation") : verdict_words("source.model"))},
       {"deviation", deviation_words(verdict.deviation)},
       {"tolerance", number_text(design::reached_poisson_deviation)}});
}

/// What the model says of a design about which the simulation, or the structure, says nothing.
std::string by_model(const design::Verdict& verdict) {
  if (!verdict.model_deviation) return {};
  return with_slots(verdict_words("further.by_model"), {{"deviation", deviation_words(verdict.model_deviation)}});
}

std::string sentence_about_trust(const design::Verdict& verdict) {
  if (verdict.source == design::VerdictSource::simulation || verdict.untrusted == 0) return {};
  const bool most = verdict.doubt == Doubt::untrusted;
  return with_slots(most ? verdict_words("further.most_untrusted") : verdict_words("further.some_untrusted"),
                    {{"untrusted", std::to_string(verdict.untrusted)}, {"samples", std::to_string(verdict.samples)}});
}

std::string sentence_about_worst_target(const design::Verdict& verdict) {
  if (verdict.targets.size() < 2) return {};
  return with_slots(verdict_words("further.worst_target"),
                    {{"count", std::to_string(verdict.targets.size())}, {"number", std::to_string(verdict.worst + 1)}});
}

/// Whether the design misses a target and comes no nearer to it than the deviation.
bool is_no_nearer(const design::TargetVerdict& target, double deviation) {
  return !target.is_reached && target.deviation && *target.deviation >= deviation;
}

/// A sentence for each target that no material can have by itself.
std::string sentences_about_single_targets(const design::Verdict& verdict, const BoundedTargets& bounded) {
  std::string text;
  for (std::size_t t = 0; t < bounded.targets.size(); ++t) {
    const auto& bound = bounded.bounds.targets[t];
    if (!bound || design::is_reached_as_a_whole(bounded.targets[t], bound->alone.y)) continue;
    if (!is_no_nearer(verdict.targets[t], bound->alone.deviation)) continue;
    const bool is_only = bounded.targets.size() == 1;
    text += (text.empty() ? "" : " ") +
            with_slots(is_only ? verdict_words("bound.alone") : verdict_words("bound.numbered"),
                       {{"deviation", percentage(bound->alone.deviation)}, {"number", std::to_string(t + 1)}});
  }
  return text;
}

/// A sentence about targets that no material can have together; empty if the design comes nearer to them.
std::string sentence_about_targets_together(const design::Verdict& verdict, const BoundedTargets& bounded) {
  std::size_t count = 0;
  double squares = 0;
  double weights = 0;
  bool is_beyond_reach = false;
  bool is_missed = false;
  for (std::size_t t = 0; t < bounded.targets.size(); ++t) {
    const auto& bound = bounded.bounds.targets[t];
    if (!bound || !bound->together) continue;
    const design::TargetVerdict& target = verdict.targets[t];
    if (!target.deviation) return {};
    ++count;
    squares += bounded.weights[t] * *target.deviation * *target.deviation;
    weights += bounded.weights[t];
    is_beyond_reach |= !design::is_reached_as_a_whole(bounded.targets[t], bound->together->y);
    is_missed |= !target.is_reached;
  }
  const double together = bounded.bounds.together.value_or(0);
  if (!is_beyond_reach || !is_missed || std::sqrt(squares / weights) < together) return {};
  return with_slots(verdict_words("bound.together"),
                    {{"deviation", percentage(together)}, {"count", std::to_string(count)}});
}

}  // namespace

std::string bound_sentence(const design::Verdict& verdict, const BoundedTargets& bounded) {
  const std::string single = sentences_about_single_targets(verdict, bounded);
  return single.empty() ? sentence_about_targets_together(verdict, bounded) : single;
}

std::string verdict_sentence(const design::Verdict& verdict) {
  std::vector<std::string> sentences{heading(verdict)};
  if (verdict.doubt == Doubt::no_structure || (verdict.doubt == Doubt::incomplete && !has_values(verdict))) {
    sentences.push_back(by_model(verdict));
  } else if (verdict.doubt != Doubt::untrusted) {
    const std::string about_ranges = sentence_about(verdict.targets[verdict.worst]);
    if (!about_ranges.empty()) sentences.push_back(sentence_about_worst_target(verdict));
    sentences.push_back(about_ranges);
  }
  if (verdict.doubt != Doubt::no_structure) sentences.push_back(sentence_about_trust(verdict));
  std::string text;
  for (const std::string& sentence : sentences)
    if (!sentence.empty()) text += (text.empty() ? "" : " ") + sentence;
  return text;
}

}  // namespace supple::json
