#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "job.h"

namespace supple::jobs {

/// What the computation of a token throws whose stop was requested for this reason.
std::exception_ptr failure_of_stop(StopReason reason);

/// Tells the log which computations do not stop. Any thread may call.
class AbandonmentLog {
 public:
  /// `count`: number of computations that do not stop now.
  AbandonmentLog(JobQueue::Log log, std::function<std::size_t()> count);
  /// `whose` names the request or the job as log::Context does.
  void note_abandoned(const std::string& whose, const Computation& computation, const Watchdog::Overdue& overdue) const;
  void note_returned(const Computation& computation, const Watchdog::Overdue& overdue) const;

 private:
  const JobQueue::Log log_;
  const std::function<std::size_t()> count_;
};

}  // namespace supple::jobs
