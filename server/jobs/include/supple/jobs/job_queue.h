#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "supple/budget/memory.h"
#include "supple/jobs/computation.h"
#include "supple/store/store.h"

namespace supple::jobs {

/// A job as a client sees it: its record and its progress.
struct JobStatus {
  store::JobRecord record;
  double progress = 0;  ///< in [0, 1]
  std::string stage;
  std::string partial{};      ///< JSON of an intermediate result while it runs; empty where there is none
  std::int64_t revision = 0;  ///< revision of the progress that another server has reported
};

struct QueueOptions {
  int workers = 2;    ///< jobs that run at the same time, and as many in the background
  int immediate = 4;  ///< immediate computations that run at the same time
  // The following two are the limits of jobs in the background, and once more those of the others.
  std::size_t max_queue = 1000;                ///< jobs that wait for a worker; setting --max-queue
  std::int64_t max_queue_bytes = 256LL << 20;  ///< bytes of memory that those hold; setting --max-queue-bytes
  double retention = 7 * 86400;                ///< seconds for which a finished job is stored; setting --retention
  std::size_t max_jobs = 10'000;               ///< finished jobs that are stored; setting --max-jobs
  budget::MemoryBudget* memory = nullptr;      ///< memory that computations may take; null: any amount
  /// Starts of a job, since it saved something for the next one, before it fails because the process crashed in each;
  /// setting --max-attempts.
  int max_attempts = 3;
  std::function<void()> clean_up_too{};  ///< called every minute by the cleaner, after its own work
};

/// Runs computations: immediately on the caller's thread, or as jobs on worker threads.
///
/// Interactive computations start before normal ones, as far as ClientTurns (client_turns.h) says. They also
/// start where `workers` jobs, or `immediate` computations, run already: one more may run if it is interactive.
/// Background computations run on workers of their own, as many as the others have. Their threads have a lower
/// priority, so that they delay no other computation (background_threads.h).
///
/// A job that comes with its request outlives the process. The next process runs it with the same id, client and
/// session, in the same order, and its deadline counts anew. That holds for jobs that waited and for jobs that ran,
/// whether the process crashed or shut down. A job fails with "job.given_up" if the process crashed in each of its
/// `max_attempts` starts. Only one job at a time runs its last attempt. So if the process crashes again, only the job
/// that caused it fails, and not the jobs beside it.
///
/// The problem of a failed job is stored as the text that `render` makes of it. A job whose result cannot be stored
/// fails with the reason ("store.full", "store.unavailable"). If the store does not take that end either, it is held in
/// memory, where every client sees it, and written as soon as the store takes it.
///
/// Its parts are a scheduler (queue, fairness, sessions), a journal (the store, and ends that it refused), a runner of
/// jobs, a runner of immediate computations and, for a shared store, a lease keeper. Any thread may call.
class JobQueue {
 public:
  using Render = std::function<std::string(const problem::Problem&)>;
  /// Receives the record of every finished job.
  using Observe = std::function<void(const store::JobRecord&)>;
  /// Receives lines for the log: which ends the store refused, which computations do not stop, and what was thrown at
  /// the end of a job. Called from any thread.
  using Log = std::function<void(const std::string&)>;
  /// Makes a computation again from its request, and throws what a client would have been told. Called on a worker.
  /// `execution` is the one of the computation, so that a stop request also ends the loading of what it needs.
  using Remake = std::function<Computation(const store::JobRecord&, store::StoredRequest, const Execution& execution)>;

  /// Queues the jobs that an earlier process left unfinished. Those without their request, and all if `remake` is
  /// empty, fail with "job.interrupted".
  JobQueue(store::Store& store, const QueueOptions& options, Render render, Observe observe, const Log& log = {},
           Remake remake = {});
  /// Shuts down without grace, and waits for the workers of abandoned jobs.
  ~JobQueue();
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// Computes on this thread within a compute slot, or on a worker if it is in the background, for which the queue must
  /// have a place ("job.queue_full", "job.client_queue_full"). Throws what the computation throws, "job.cancelled" once
  /// `waiting.hung_up` returns true, "job.deadline_exceeded", "server.shutting_down". Stores nothing. `profile`, if
  /// there is one, is filled however the computation ends.
  ///
  /// A computation that goes on for Watchdog::patience after its deadline, after it has turned to its report, or after
  /// its client has hung up, is abandoned: `waiting` is answered, and others get its slot, as long as no more than
  /// `immediate` are abandoned. This call returns when the computation does, and drops its result. One in the
  /// background is abandoned as a job is: this call throws at once, while the computation goes on. So it must own all
  /// that it uses.
  store::Result run_now(const Computation& computation, Waiting waiting, Profile* profile = nullptr);

  /// Makes the computation a job that waits for a worker, and that outlives the process if it comes with its request.
  /// If a job has the same idempotency key, that one is returned. Throws "job.key_reused" if that job had another
  /// request, "job.queue_full", "job.client_queue_full", "server.shutting_down", "store.full", "store.quota",
  /// "store.unavailable".
  JobStatus submit(Computation computation, const std::optional<RequestOfJob>& request = {});

  /// Computes on a worker, and waits for the result or for `seconds`. After that it has become a job, as by `submit`.
  /// Throws what run_now and submit throw. If the client hangs up meanwhile, the computation is cancelled.
  struct ResultOrJob {
    std::optional<store::Result> result;
    JobStatus job;
  };
  ResultOrJob run_within(Computation computation, double seconds, const std::function<bool()>& hung_up,
                         const std::optional<RequestOfJob>& request = {});

  /// Throws "job.not_found".
  JobStatus status(const std::string& id) const;
  /// The newest first, of one owner if `owner` is not empty. `after` is the last id of the previous page.
  std::vector<JobStatus> list(std::optional<store::JobState> state, std::size_t limit, const std::string& after,
                              const std::string& owner = {}) const;
  /// The result of a successful job. Throws "job.not_found", "job.not_finished" and "job.dismissed".
  store::StoredResult result(const std::string& id) const;
  /// Dismisses an unfinished job at once and requests its stop, or removes a finished job and one that is left to the
  /// next process. Returns the dismissed job, or the job as it is, if it ended at the same time; nothing if the job was
  /// removed. Throws "job.not_found".
  std::optional<JobStatus> remove(const std::string& id);
  /// Waits until the job's status has changed since `version`, or for `seconds`. Updates `version`; with 0 it returns
  /// at once.
  JobStatus wait_for_change(const std::string& id, std::uint64_t& version, double seconds) const;

  bool mesh_in_use(const std::string& mesh) const;
  std::size_t running() const;
  std::size_t waiting() const;
  std::size_t waiting(Priority priority) const;  ///< jobs of this priority that wait for a worker
  int immediate() const;
  /// Number of computations that do not stop, and whose callers were answered.
  std::size_t abandoned() const;

  /// Refuses new computations, gives running ones `grace_seconds` to finish, and then stops them. Jobs that have not
  /// finished wait for the next process, or fail with "job.interrupted" if that could not make them again. Returns when
  /// the workers have ended, except those of abandoned jobs, for which the destructor waits.
  void shut_down(double grace_seconds);

 private:
  struct Parts;
  const std::unique_ptr<Parts> parts_;
};

}  // namespace supple::jobs
