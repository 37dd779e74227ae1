#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>

#include "supple/lab/dataset_maker.h"

namespace supple::lab {

/// Says on stderr how far a data set has come, how fast it is and when it will be done: one line that is drawn anew on
/// a terminal, a line every minute elsewhere.
class ProgressLine : public MakeListener {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine() override;

  void started(std::int64_t designs, std::int64_t found, std::int64_t states_per_design) override;
  void state_reached() override;
  void design_done(const dataset::Design& design) override;

 private:
  using Clock = std::chrono::steady_clock;
  /// Prints unless it has just done so.
  void show(bool at_once);

  const bool quiet_;
  const bool terminal_;
  std::mutex mutex_;
  Clock::time_point start_;
  Clock::time_point shown_;
  std::int64_t designs_ = 0;
  std::int64_t found_ = 0;
  std::int64_t states_per_design_ = 0;
  std::int64_t done_ = 0;
  std::int64_t rejected_ = 0;
  std::int64_t stopped_paths_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t settled_states_ = 0;  ///< of designs that are done, reached or not
  std::int64_t pending_states_ = 0;  ///< reached in designs at work
  bool drawn_ = false;
};

}  // namespace supple::lab
