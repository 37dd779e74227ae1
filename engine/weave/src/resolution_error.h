#pragma once

#include <chrono>
#include <cstddef>
#include <string_view>
#include <vector>

#include "supple/base/cost_ledger.h"
#include "supple/weave/homogenization.h"

namespace supple::weave {

/// Options with which directions are followed once more, to see what the rods' resolution changes.
struct OtherResolution {
  EquilibriumOptions equilibrium;
  /// Ratio of the estimated error to the difference between both resolutions. With 4 segments or more the other
  /// resolution has half as many, and the difference is .94 to 3 times the error, which falls with the first power of
  /// the number of segments at worst and with its square at last.
  double factor = 1;
};
/// The other resolution has half as many segments. One segment cannot be halved and is compared with two.
OtherResolution other_resolution(const EquilibriumOptions& options);

/// The indices of the responses that are followed once more (`compared_positions`), ordered by their angles over half
/// a turn.
std::vector<std::size_t> compared_directions(const std::vector<DirectionalResponse>& responses, Switch error_estimate);

/// Sets the errors of all responses. `compared` has the responses of the other resolution for the indices `at`, which
/// are those of `compared_directions`. A direction between two of them takes the larger of their errors, absolute or
/// relative. Each error includes what the tolerance and sliders short of their limits leave. `area` is that of the cell
/// at rest, mm^2.
void set_errors(const std::vector<std::size_t>& at, const std::vector<DirectionalResponse>& compared, double factor,
                double area, const HomogenizationOptions& options, std::vector<DirectionalResponse>& responses);

/// The positions of the entries that are computed once more: all where the switch is on, and at most 24, evenly spread,
/// where it is automatic.
std::vector<std::size_t> compared_positions(std::size_t total, Switch error_estimate);

/// Sets the errors of the states at these indices, from the states `compared` of the other resolution.
void set_errors(const std::vector<std::size_t>& at, const std::vector<CellState>& compared, double factor,
                std::vector<CellState>& states);

/// What an estimate of errors compared: `count` of `total` entries were computed once more before time or memory ran
/// out.
struct Compared {
  std::size_t count = 0;
  std::size_t total = 0;
  std::string_view entries;  ///< their name in the plural
  int segments = 0;          ///< of the other resolution
};

/// Measures the time of an estimate of errors for its lifetime, and bills it to the stage "error estimate" however the
/// estimate ends. A null ledger costs nothing.
class EstimateTimer {
 public:
  explicit EstimateTimer(CostLedger* cost) : cost_(cost) {}
  ~EstimateTimer() {
    if (cost_) cost_->add_stage("error estimate", seconds());
  }
  EstimateTimer(const EstimateTimer&) = delete;
  EstimateTimer& operator=(const EstimateTimer&) = delete;

  /// Bills the effect "error_estimate", which ran if anything was compared, with the time until now.
  void bill(const Compared& compared) const;

 private:
  using Clock = std::chrono::steady_clock;
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  CostLedger* cost_;
  Clock::time_point start_ = Clock::now();
};

/// Bills that the effect did not run, since it is off, or automatic for a sheet.
void bill_no_estimate(Switch error_estimate, CostLedger* cost);
/// Bills that the effect did not run, since time or memory ran out before.
void bill_estimate_without_time(CostLedger* cost);

/// Whether time or memory ran out before this state was finished, or after it where it is a sheet's.
constexpr bool is_cut_short(Stop stop) { return stop == Stop::deadline || stop == Stop::memory; }

}  // namespace supple::weave
