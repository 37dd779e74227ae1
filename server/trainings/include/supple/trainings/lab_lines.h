#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace supple::trainings {

/// What `supple-lab plan` prints.
struct LabPlan {
  std::string options;            ///< of `supple-lab learn`, separated by blanks
  double simulation_seconds = 0;  ///< core-seconds
  double training_seconds = 0;    ///< core-seconds
  std::int64_t even_designs = 0;
  std::int64_t rounds = 0;         ///< of designs that a committee of networks chooses
  std::int64_t round_designs = 0;  ///< designs of a round
};

/// Reads its lines one after the other.
class LabPlanReader {
 public:
  void read(std::string_view line);
  /// The plan, once all lines have come.
  std::optional<LabPlan> plan() const;

 private:
  LabPlan plan_;
  int lines_ = 0;
};

/// One line that `supple-lab learn` prints while it runs.
struct LabProgress {
  double fraction = 0;  ///< of the run
  std::string stage;    ///< "designs", "committee", "network" or "error bars"
};
struct LabError {
  double error = 0;          ///< mean relative error of the stress on designs held out
  std::int64_t designs = 0;  ///< that were simulated by then
};

std::optional<LabProgress> progress_in(std::string_view line);
std::optional<LabError> error_in(std::string_view line);

}  // namespace supple::trainings
