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

/// Whose jobs a worker runs: background jobs have workers of their own, which compute on background threads.
enum class WorkerKind { foreground, background };

/// Decides which job runs next, on which worker, and which worker has to be replaced. It does no input or output.
/// While its mutex is locked, it locks at most those of the board and of the sessions, under which no other is locked.
class Scheduler {
 public:
  /// The place of a worker thread.
  struct Seat {
    WorkerKind kind = WorkerKind::foreground;
    JobPointer job{};                      ///< the job that it computes
    std::string client{};                  ///< client of its job, also after `set_computed` has reset `job`
    Priority priority = Priority::normal;  ///< priority of that job
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

  Seat& add_seat(WorkerKind kind = WorkerKind::foreground);
  void remove_seat(const Seat& seat);
  struct Task {
    JobPointer job;
    std::optional<store::JobRecord> record;  ///< what the store has to write; empty if the job has no row
  };
  /// Waits for the next job of this worker; nothing when the workers end. Where QueueOptions::workers jobs run, a
  /// further one has to be interactive.
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
  /// QueueOptions::workers jobs are abandoned at the same time, and as many in the background. A job is returned by
  /// every call until its computation has returned, since the thread that was to end it may have failed.
  std::vector<LateJob> abandon_late_jobs();
  /// Number of workers of a kind that do not exist yet, with those that should replace workers of abandoned jobs.
  std::size_t missing_workers(WorkerKind kind) const;
  std::size_t abandoned() const;
  bool is_abandoned(const Seat& seat) const;

  std::vector<JobPointer> stopped_jobs() const;
  std::size_t running() const;
  std::size_t waiting() const;
  /// Number of jobs of this priority that wait.
  std::size_t waiting(Priority priority) const;
  /// Number of workers for which no job waits; nothing when the process shuts down.
  std::optional<store::IdleWorkers> idle_workers() const;

  /// Refuses further jobs, and requests the stop of those that wait.
  void refuse();
  /// Waits until no job runs except abandoned ones, or until `end` if there is one.
  void wait_until_idle(std::optional<Clock::time_point> end) const;
  /// Ends the workers that have no job.
  void end();
  std::vector<JobPointer> waiting_jobs() const;

 private:
  /// The workers of a kind.
  struct Workers {
    std::condition_variable work{};  // for those that wait: there may be a job to run, or they end
    std::size_t running = 0;         // jobs that run, except abandoned ones
    std::size_t abandoned_jobs = 0;  // jobs whose workers are replaced
  };

  // The caller of the following functions holds the mutex.
  Workers& workers_for(Priority priority) {
    return workers_of(priority == Priority::background ? WorkerKind::background : WorkerKind::foreground);
  }
  Workers& workers_of(WorkerKind kind) { return kind == WorkerKind::background ? background_ : foreground_; }
  const Workers& workers_of(WorkerKind kind) const {
    return kind == WorkerKind::background ? background_ : foreground_;
  }
  /// The job that a worker of this kind may start now; null if there is none.
  JobPointer next_job(WorkerKind kind) const;
  std::size_t seats(WorkerKind kind) const;
  void add(const JobPointer& job, bool waits_for_row);
  void set_idle(Seat& seat);
  std::size_t worker_limit() const { return static_cast<std::size_t>(options_.workers); }

  const QueueOptions& options_;
  JobBoard& board_;
  Sessions& sessions_;
  mutable std::mutex mutex_;
  mutable std::condition_variable idle_;
  FairQueue queue_;
  std::list<Seat> seats_;
  Workers foreground_;
  Workers background_;
  bool refusing_ = false;
  bool ending_ = false;
};

}  // namespace supple::jobs
