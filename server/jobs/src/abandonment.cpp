#include "abandonment.h"

#include <chrono>
#include <cstdio>
#include <utility>

namespace supple::jobs {
namespace {

/// For example "1.02 s after its deadline".
std::string lateness(const Watchdog::Overdue& overdue) {
  const std::chrono::duration<double> late = Clock::now() - overdue.since;
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.2f", late.count());
  return std::string(seconds) + " s after " +
         (overdue.reason == StopReason::deadline ? "its deadline" : "it was to stop");
}

}  // namespace

std::exception_ptr failure_of_stop(StopReason reason) {
  const CancellationToken stopped;
  stopped.request(reason);
  try {
    stopped.throw_if_requested();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

AbandonmentLog::AbandonmentLog(JobQueue::Log log, std::function<std::size_t()> count)
    : log_(std::move(log)), count_(std::move(count)) {}

void AbandonmentLog::note_abandoned(const std::string& whose, const Computation& computation,
                                    const Watchdog::Overdue& overdue) const {
  if (log_)
    log_(whose + "the computation " + computation.kind + " does not stop: abandoned " + lateness(overdue) + ", " +
         std::to_string(count_()) + " such computations run");
}

void AbandonmentLog::note_returned(const Computation& computation, const Watchdog::Overdue& overdue) const {
  if (log_) log_("the abandoned computation " + computation.kind + " has returned " + lateness(overdue));
}

}  // namespace supple::jobs
