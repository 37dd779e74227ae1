#pragma once

#include <condition_variable>
#include <cstddef>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "fair_queue.h"
#include "job_board.h"
#include "sessions.h"

namespace supple::jobs {

/// Decides which job runs next, on which worker, and which worker has to be replaced. It does no input or output.
/// While its mutex is locked, it locks at most those of the board and of the sessions, under which no other is locked.
class Scheduler {
 public:
  /// The place of a worker thread.
  struct Seat {
    JobPointer job{};      ///< the job that it computes
    std::string client{};  ///< client of its job, also after `set_computed` has reset `job`
    Clock::time_point begin{};
    bool is_last_attempt = false;
    std::optional<Watchdog::Overdue> abandoned{};  ///< set if its job is abandoned, so that another worker replaces it
  };

  Scheduler(const QueueOptions& options, JobBoard& board, Sessions& sessions)
      : options_(options), board_(board), sessions_(sessions), queue_(options) {}

  /// Queues a job and enters its session. A job whose row in the store is still being written only takes its place in
  /// the queue, until `enter_session` and `resume`. Throws "server.shutting_down" and as FairQueue::require_place does.
  void admit(const JobPointer& job);
  /// Queues a job of an earlier process or of another server, whatever the limits. False if the job is known, or if
  /// this process shuts down.
  bool adopt(const JobPointer& job);
  void enter_session(Job& job);
  /// A job that waits is not run before `resume`.
  void pause(const Job& job);
  void resume(const Job& job);
  /// The job ends: it leaves the queue and its session.
  void forget(const Job& job);

  Seat& add_seat();
  void remove_seat(const Seat& seat);
  struct Task {
    JobPointer job;
    std::optional<store::JobRecord> record;  ///< what the store has to write; empty if the job has no row
  };
  /// Waits for the next job of this worker; nothing when the workers end.
  std::optional<Task> take(Seat& seat);
  /// The computation of the worker's job has returned.
  void set_computed(Seat& seat);
  /// The worker is free again. Returns since when its job was overdue, if it was abandoned.
  std::optional<Watchdog::Overdue> leave(Seat& seat);

  struct LateJob {
    JobPointer job;
    Watchdog::Overdue since;
    bool is_abandoned = false;  ///< whether this call has abandoned it
  };
  /// Returns the jobs whose computations do not stop, and abandons them, so that their workers are replaced. At most
  /// QueueOptions::workers jobs are abandoned at the same time. A job is returned by every call until its computation
  /// has returned, since the thread that was to end it may have failed.
  std::vector<LateJob> abandon_late_jobs();
  /// Number of workers that should replace those of abandoned jobs and do not exist yet.
  std::size_t missing_workers() const;
  std::size_t abandoned() const;
  bool is_abandoned(const Seat& seat) const;

  std::vector<JobPointer> stopped_jobs() const;
  std::size_t running() const;
  std::size_t waiting() const;
  /// Number of workers for which no job waits; nothing when the process shuts down.
  std::optional<std::size_t> idle_workers() const;

  /// Refuses further jobs, and requests the stop of those that wait.
  void refuse();
  /// Waits until no job runs except abandoned ones, or until `end` if there is one.
  void wait_until_idle(std::optional<Clock::time_point> end) const;
  /// Ends the workers that have no job.
  void end();
  std::vector<JobPointer> waiting_jobs() const;

 private:
  // The caller of the following functions holds the mutex.
  void add(const JobPointer& job, bool waits_for_row);
  void set_idle(Seat& seat);
  std::size_t worker_limit() const { return static_cast<std::size_t>(options_.workers); }

  const QueueOptions& options_;
  JobBoard& board_;
  Sessions& sessions_;
  mutable std::mutex mutex_;
  std::condition_variable work_;  // for workers: there may be a job to run, or they end
  mutable std::condition_variable idle_;
  FairQueue queue_;
  std::list<Seat> seats_;
  std::size_t running_ = 0;         // jobs that run, except abandoned ones
  std::size_t abandoned_jobs_ = 0;  // jobs whose workers are replaced
  bool refusing_ = false;
  bool ending_ = false;
};

}  // namespace supple::jobs
