#pragma once

#include <exception>
#include <list>
#include <optional>
#include <thread>

#include "abandonment.h"
#include "journal.h"
#include "scheduler.h"

namespace supple::jobs {

/// Runs jobs on worker threads and ends them: the scheduler says which job is next, the journal stores how it ended,
/// and the board shows it. Any thread may call, except where a function says otherwise. No mutex is locked while a
/// computation, the store or an observer is called.
class JobRunner {
 public:
  JobRunner(store::Store& store, const QueueOptions& options, Watchdog& watchdog, JobBoard& board, Scheduler& scheduler,
            Journal& journal, const AbandonmentLog& abandonment_log, JobQueue::Log log, JobQueue::Observe observe,
            JobQueue::Remake remake);
  /// Ends the workers, and waits for those of abandoned jobs.
  ~JobRunner();
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// A new job, which nobody knows yet.
  JobPointer make_job(Computation computation, bool has_request, Row row) const;
  /// Queues a job that another process has accepted, or fails it if it cannot run again.
  void take_over(store::JobRecord record);

  /// Ends a job as dismissed and stops its computation. False if it has not ended here, since it belongs to the next
  /// process or to another server.
  bool dismiss(const JobPointer& job);
  /// Stops a job that another server has taken or dismissed. Does not wait for a thread that ends the job.
  void lose(const JobPointer& job);
  /// Ends a job that waits, whose stop was requested.
  void end_stopped(const JobPointer& job);

  /// Adds the workers that are missing. For one thread at a time.
  void add_workers();
  /// Fails the jobs whose computations do not stop, and replaces their workers. For one thread at a time.
  void abandon_late_jobs();
  /// Ends the workers, except those of abandoned jobs. For one thread at a time, and no worker has another job.
  void end_workers();

 private:
  struct Worker {
    Scheduler::Seat& seat;
    std::thread thread{};
  };

  void add_workers(WorkerKind kind);
  void work(Scheduler::Seat& seat);
  /// Takes a step for a job. What it throws is logged and returned, so that the thread goes on with other jobs.
  template <typename Step>
  std::exception_ptr try_step(const Job& job, const Step& step) const noexcept;
  void run(const Scheduler::Task& task, Scheduler::Seat& seat);
  void end(const JobPointer& job, JobState state, std::optional<Result> result, std::exception_ptr failure);
  /// Stores the end. False if another server has the job.
  bool store_end(const JobPointer& job, JobBoard::Claim& claim, JobState state, std::optional<Result> result,
                 std::exception_ptr failure);
  /// The computation that runs a job of another process again.
  Computation computation_again(const store::JobRecord& record);

  store::Store& store_;
  const QueueOptions& options_;
  Watchdog& watchdog_;
  JobBoard& board_;
  Scheduler& scheduler_;
  Journal& journal_;
  const AbandonmentLog& abandonment_log_;
  const JobQueue::Log log_;
  const JobQueue::Observe observe_;
  const JobQueue::Remake remake_;
  std::list<Worker> workers_;
};

}  // namespace supple::jobs
