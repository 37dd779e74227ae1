#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>

#include "supple/lab/dataset_maker.h"

namespace supple::lab {

/// Shows on stderr the progress of a data set, the rows per second and the remaining time. On a terminal it is one line
/// that is redrawn. Otherwise a line is written every minute.
class ProgressLine : public MakeListener {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine() override;

  void started(std::int64_t designs, std::int64_t already_finished, std::int64_t states_per_design) override;
  void state_reached() override;
  void design_done(const dataset::Design& design) override;

 private:
  using Clock = std::chrono::steady_clock;
  /// Prints the line. Does nothing if the last line is too recent, unless `force`.
  void show(bool force);

  const bool quiet_;
  const bool terminal_;
  std::mutex mutex_;
  Clock::time_point start_;
  Clock::time_point shown_;
  std::int64_t designs_ = 0;
  std::int64_t already_finished_ = 0;
  std::int64_t states_per_design_ = 0;
  std::int64_t done_ = 0;
  std::int64_t rejected_ = 0;
  std::int64_t stopped_paths_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t finished_states_ = 0;  ///< states of finished designs, including those that were not reached
  std::int64_t pending_states_ = 0;   ///< states that were reached in unfinished designs
  bool drawn_ = false;                ///< whether a line on the terminal has to be ended
};

}  // namespace supple::lab
