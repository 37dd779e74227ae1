#include "supple/design/verdict.h"

#include <algorithm>
#include <limits>

namespace supple::design {
namespace {

TargetVerdict target_verdict(const CurveAtSamples& curve) {
  TargetVerdict verdict;
  verdict.task = curve.target.samples.task;
  const auto reached = curve.target.reached(curve.values);
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (!curve.target.has_weight(i)) continue;
    ++verdict.samples;
    if (reached[i] != 0) ++verdict.reached;
  }
  verdict.deviation = curve.target.relative_rms(curve.values);
  verdict.ranges = fit_ranges(curve.target, curve.values);
  verdict.is_reached = is_reached_as_a_whole(curve.target, curve.values);
  return verdict;
}

double or_infinite(const std::optional<double>& deviation) {
  return deviation.value_or(std::numeric_limits<double>::infinity());
}

/// Whether `a` is worse than `b`. A target that is reached is never worse than one that is not.
bool is_worse(const TargetVerdict& a, const TargetVerdict& b) {
  if (a.is_reached != b.is_reached) return b.is_reached;
  return or_infinite(a.deviation) > or_infinite(b.deviation);
}

/// The largest deviation of all targets; none if one of them has none.
std::optional<double> worst_deviation(const std::vector<CurveAtSamples>& curves) {
  std::optional<double> worst = 0;
  for (const auto& [target, values] : curves) {
    const auto deviation = target.relative_rms(values);
    if (or_infinite(deviation) >= or_infinite(worst)) worst = deviation;
  }
  return worst;
}

/// Numbers of the samples of a target that have weight.
struct TrustCount {
  std::size_t samples = 0;
  std::size_t untrusted = 0;
};

std::vector<TrustCount> trust_counts(const Evidence& evidence) {
  std::vector<TrustCount> counts(evidence.trusted.size());
  for (std::size_t t = 0; t < counts.size(); ++t) {
    for (std::size_t i = 0; i < evidence.trusted[t].size(); ++i) {
      if (!evidence.model[t].target.has_weight(i)) continue;
      ++counts[t].samples;
      if (evidence.trusted[t][i] == 0) ++counts[t].untrusted;
    }
  }
  return counts;
}

bool is_mostly_untrusted(const Evidence& evidence) {
  const auto counts = trust_counts(evidence);
  return std::any_of(counts.begin(), counts.end(), [](const TrustCount& count) {
    const double limit = untrusted_fraction * static_cast<double>(count.samples);
    return count.samples > 0 && static_cast<double>(count.untrusted) >= limit;
  });
}

Doubt doubt_about(const Evidence& evidence, const Verdict& verdict) {
  if (!evidence.has_structure) return Doubt::no_structure;
  if (!verdict.deviation) return Doubt::incomplete;
  const bool by_model = verdict.source == VerdictSource::model;
  return by_model && is_mostly_untrusted(evidence) ? Doubt::untrusted : Doubt::none;
}

}  // namespace

std::string_view to_string(Grade grade) {
  switch (grade) {
    case Grade::reached:
      return "reached";
    case Grade::close:
      return "close";
    case Grade::missed:
      return "missed";
    case Grade::unknown:
      return "unknown";
  }
  return "";
}

std::string_view to_string(VerdictSource source) {
  return source == VerdictSource::simulation ? "simulation" : "model";
}

Grade grade_of(double deviation) {
  if (deviation <= max_reached_deviation) return Grade::reached;
  return deviation <= max_close_deviation ? Grade::close : Grade::missed;
}

Verdict judge(const Evidence& evidence) {
  Verdict verdict;
  const bool simulated = !evidence.simulated.empty();
  verdict.source = simulated ? VerdictSource::simulation : VerdictSource::model;
  for (const CurveAtSamples& curve : simulated ? evidence.simulated : evidence.model)
    verdict.targets.push_back(target_verdict(curve));
  for (std::size_t t = 0; t < verdict.targets.size(); ++t)
    if (is_worse(verdict.targets[t], verdict.targets[verdict.worst])) verdict.worst = t;
  if (!verdict.targets.empty()) verdict.deviation = verdict.targets[verdict.worst].deviation;
  verdict.model_deviation = worst_deviation(evidence.model);
  for (const TrustCount& count : trust_counts(evidence)) {
    verdict.untrusted += count.untrusted;
    verdict.samples += count.samples;
  }
  verdict.doubt = doubt_about(evidence, verdict);
  if (verdict.doubt == Doubt::none)
    verdict.grade = verdict.targets[verdict.worst].is_reached ? Grade::reached : grade_of(*verdict.deviation);
  return verdict;
}

Evidence evidence_of(const Design& design, const Polished* verification) {
  Evidence evidence;
  evidence.has_structure = design.measures.has_value();
  for (const DesignProfile& profile : design.profiles) {
    evidence.model.push_back({profile.target, profile.achieved});
    evidence.trusted.push_back(profile.in_range);
  }
  if (!verification || !is_simulated(*verification)) return evidence;
  for (std::size_t t = 0; t < verification->targets.size(); ++t)
    evidence.simulated.push_back({verification->targets[t], verification->simulated[t]});
  return evidence;
}

}  // namespace supple::design
