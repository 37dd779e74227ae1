#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "supple/base/progress.h"
#include "supple/jobs/job_queue.h"

namespace supple::jobs {

using Clock = Watchdog::Clock;
using store::JobState;
using store::Result;

/// The code of what a stop at the server's end throws.
constexpr const char* stopped_by_shutdown = "server.shutting_down";
constexpr std::chrono::milliseconds progress_period{100};  // between two published states of progress

inline Clock::duration duration(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

inline bool is_finished(JobState state) { return state != JobState::accepted && state != JobState::running; }

/// The problem of a job that did not run to its end and is not run again.
inline problem::Problem interrupted() {
  return {"job.interrupted", "The server stopped before the job had finished.", {}, {}, {}};
}

/// What a client is told whose computation was to stop.
problem::Problem problem_of_stop(StopReason reason);

[[noreturn]] inline void throw_not_found(const std::string& id) {
  throw Error("job.not_found", "There is no job " + id + ".");
}

/// All members but the token and what is atomic are guarded by the queue's mutex, which others hold while they write.
struct JobQueue::Job final : ProgressSink {
  Job(JobQueue& owner, Computation work) : queue(owner), computation(std::move(work)) {}

  void report(double fraction, std::string_view name) override {
    const auto now = Clock::now();
    if (now - last_report < progress_period && last_report != Clock::time_point{}) return;
    last_report = now;
    const std::lock_guard lock(queue.mutex_);
    progress = std::clamp(fraction, progress, 1.0);
    stage = name;
    ++version;
    queue.changed_.notify_all();
  }

  /// The latest result is not left out: what was published within the period waits for the next report.
  void publish(std::string_view text) override {
    const std::lock_guard lock(queue.mutex_);
    partial = text;
    const auto now = Clock::now();
    if (now - last_published < progress_period) return;
    last_published = now;
    ++version;
    queue.changed_.notify_all();
  }

  JobQueue& queue;
  Computation computation;
  store::JobRecord record;
  CancellationToken token;
  Clock::time_point due{};  // when its deadline passes
  std::unique_ptr<Watchdog::Guard> watch;
  bool computing = false;                      // a worker runs it
  std::optional<Clock::time_point> left_at{};  // by its client, before it was visible
  Clock::time_point ended_at{};                // when it was finished, whatever its worker does
  Clock::time_point last_report{};             // of the computing thread alone
  Clock::time_point last_published{};
  double progress = 0;
  std::string stage;
  std::string partial;
  std::uint64_t in_session = 0;
  std::uint64_t version = 1;
  std::uint64_t shared_version = 0;    // that other servers of a shared store were told of
  bool visible = false;                // in the store, and clients may ask for it
  bool kept = false;                   // so is its request: a later process can make it again
  std::atomic<bool> runs_here{false};  // in a shared store no other server can take it, unless this one is given up
  bool dismissed = false;              // by a client: however its computation ends, that is its state
  bool lost = false;                   // to another server of a shared store: how it ends here is of no account
  bool finishing = false;              // one thread writes how it ended
  bool finished = false;               // also once it was dismissed
  std::optional<Result> result;        // of one that is not visible
  std::exception_ptr failure;
};

}  // namespace supple::jobs
