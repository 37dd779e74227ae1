// What becomes of computations that do not stop.

#include <algorithm>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

#include "job.h"
#include "supple/log/context.h"

namespace supple::jobs {
namespace {

/// "1.02 s after its deadline"
std::string how_late(const Watchdog::Overdue& overdue) {
  const std::chrono::duration<double> late = Clock::now() - overdue.since;
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.2f", late.count());
  return std::string(seconds) + " s after " +
         (overdue.reason == StopReason::deadline ? "its deadline" : "it was to stop");
}

}  // namespace

problem::Problem problem_of_stop(StopReason reason) {
  const CancellationToken stopped;
  stopped.request(reason);
  try {
    stopped.throw_if_requested();
  } catch (...) {
    return problem::problem_of(std::current_exception());
  }
  return {};
}

bool JobQueue::abandon_immediate(std::uint64_t ticket, const Watchdog::Overdue& overdue) {
  const std::lock_guard lock(mutex_);
  immediate_.at(ticket).abandoned = overdue;
  if (refusing_) changed_.notify_all();
  return ++abandoned_immediate_ <= static_cast<std::size_t>(options_.immediate);
}

std::size_t JobQueue::abandoned() const {
  const std::lock_guard lock(mutex_);
  const auto jobs = std::count_if(workers_.begin(), workers_.end(),
                                  [](const Worker& worker) { return worker.abandoned || overdue(worker); });
  return abandoned_immediate_ + static_cast<std::size_t>(jobs);
}

std::optional<Watchdog::Overdue> JobQueue::overdue(const Worker& worker) {
  if (!worker.job || !worker.job->computing) return std::nullopt;
  const auto& job = *worker.job;
  if (job.finishing && !job.finished) return std::nullopt;  // another thread writes how it ended
  const auto now = Clock::now();
  if (now - job.due >= Watchdog::patience) return Watchdog::Overdue{StopReason::deadline, job.due};
  if (job.finished && now - job.ended_at >= Watchdog::patience)
    return Watchdog::Overdue{StopReason::cancelled, job.ended_at};
  if (job.left_at && now - *job.left_at >= Watchdog::patience)
    return Watchdog::Overdue{StopReason::cancelled, *job.left_at};
  return std::nullopt;
}

void JobQueue::abandon_jobs() {
  std::vector<std::pair<JobPointer, StopReason>> late;
  std::vector<std::pair<JobPointer, Watchdog::Overdue>> abandoned;
  {
    const std::lock_guard lock(mutex_);
    if (ending_) return;
    for (auto& worker : workers_) {
      const auto since = overdue(worker);
      if (!since || worker.abandoned) continue;
      if (!worker.job->finishing) late.emplace_back(worker.job, since->reason);
      const auto most = static_cast<std::size_t>(options_.workers);
      if (abandoned_jobs_ >= most) continue;
      worker.abandoned = since;
      ++abandoned_jobs_;
      --running_;
      if (std::exchange(worker.last_attempt, false)) last_attempt_runs_ = false;
      abandoned.emplace_back(worker.job, *since);
      try {
        if (workers_.size() < most + abandoned_jobs_) add_worker();
      } catch (const std::system_error&) {
        // The system gives no further thread: the jobs wait for one of those that there are.
      }
    }
    if (!abandoned.empty()) {
      work_.notify_all();
      changed_.notify_all();
    }
  }
  for (const auto& [job, since] : abandoned) tell_abandoned("job=" + job->record.id + " ", job->computation, since);
  for (const auto& [job, reason] : late) {
    const log::Context context("job", job->record.id);
    finish(job, JobState::failed, std::nullopt,
           std::make_exception_ptr(problem::ProblemError(problem_of_stop(reason))));
  }
}

void JobQueue::tell_abandoned(const std::string& whose, const Computation& computation,
                              const Watchdog::Overdue& overdue) const {
  if (log_)
    log_(whose + "the computation " + computation.kind + " does not stop: abandoned " + how_late(overdue) + ", " +
         std::to_string(abandoned()) + " such computations run");
}

void JobQueue::tell_returned(const Computation& computation, const Watchdog::Overdue& overdue) const {
  if (log_) log_("the abandoned computation " + computation.kind + " has returned " + how_late(overdue));
}

}  // namespace supple::jobs
