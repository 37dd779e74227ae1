#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "supple/design/inverse_design.h"
#include "supple/design/polish.h"
#include "supple/design/target_ranges.h"

namespace supple::design {

/// Largest relative deviation of a target that counts as close. `max_reached_deviation` is that of a target that counts
/// as reached.
inline constexpr double max_close_deviation = 0.15;
/// The model does not decide about a design if it is not trusted at this fraction of a target's samples, or at more.
inline constexpr double untrusted_fraction = 0.5;

enum class Grade { reached, close, missed, unknown };
std::string_view to_string(Grade grade);

enum class VerdictSource { simulation, model };
std::string_view to_string(VerdictSource source);

/// Why a grade is unknown.
enum class Doubt {
  none,
  untrusted,     ///< the model is not trusted at `untrusted_fraction` of the samples
  incomplete,    ///< a value is missing
  no_structure,  ///< the parameters have no structure
};

/// Values at the samples of a target, NaN where there is none.
struct CurveAtSamples {
  SampledTarget target;
  Eigen::VectorXd values;
};

/// What is known of a design. The lists have one entry for each target.
struct Evidence {
  std::vector<CurveAtSamples> model;
  std::vector<std::vector<std::uint8_t>> trusted;  ///< whether the model is trusted at each sample of `model`
  std::vector<CurveAtSamples> simulated;           ///< empty if nothing was simulated
  bool has_structure = true;
};

struct TargetVerdict {
  Task task = Task::stress_strain;
  std::size_t samples = 0;          ///< number of samples that have weight
  std::size_t reached = 0;          ///< number of those that are reached
  std::optional<double> deviation;  ///< as SampledTarget::relative_rms
  std::vector<FitRange> ranges;
  bool is_reached = false;  ///< as is_reached_as_a_whole
};

struct Verdict {
  Grade grade = Grade::unknown;
  VerdictSource source = VerdictSource::model;
  Doubt doubt = Doubt::none;
  std::optional<double> deviation;        ///< of the worst target by the source; none if a value is missing
  std::optional<double> model_deviation;  ///< of the worst target by the model
  std::size_t samples = 0;                ///< number of samples by the model that have weight, of all targets
  std::size_t untrusted = 0;              ///< number of those at which the model is not trusted
  std::vector<TargetVerdict> targets;     ///< by the source
  std::size_t worst = 0;  ///< index of the target that decides: of those that are not reached, the furthest off
};

/// The grade of a deviation that is trusted.
Grade grade_of(double deviation);

/// Judges a design by its simulation if there is one, otherwise by the model.
Verdict judge(const Evidence& evidence);

/// What is known of a design that `search_designs` found. `verification` is null if nothing was simulated, and
/// counts for nothing if it was stopped before a simulation ended.
Evidence evidence_of(const Design& design, const Polished* verification);

}  // namespace supple::design
