#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "supple/base/execution.h"
#include "supple/budget/memory.h"
#include "supple/jobs/compute_slots.h"
#include "supple/jobs/watchdog.h"
#include "supple/problem/problem.h"
#include "supple/store/store.h"

namespace supple::jobs {

/// What is to be computed. `run` gets the cancellation token and the progress sink; it makes its own cost ledger, for
/// the bill is part of the result.
struct Computation {
  std::string kind;       ///< "karcher-means"
  std::string mesh;       ///< empty where it works on none
  double deadline = 600;  ///< seconds from now
  std::function<store::Result(const Execution&)> run;
  /// An unfinished computation of the same session is stopped with "design.superseded"; empty: of none.
  std::string session{};
  /// Who asked: while others wait, nobody's jobs take more workers than theirs.
  std::string client{};
  std::string owner{};     ///< of the job that it becomes: the id of a key; empty: none
  std::int64_t bytes = 0;  ///< of memory that it holds while it waits, about: those of its request
  bool takes_slot = true;  ///< false for what reads and computes nothing: it waits for no compute slot
  int max_waiting = 0;     ///< jobs of its client that may wait for a worker; 0: no limit but that of the queue
  /// Two with the same key are one job; empty: each is one. Hashes of who asks with which key, and of what is asked.
  std::string idempotency_key{};
  std::string request_hash{};
};

/// Where an immediate computation's time and memory went.
struct Profile {
  double waited = 0;             ///< seconds for a compute slot
  double computed = 0;           ///< seconds in the slot
  std::int64_t peak_memory = 0;  ///< the most bytes that it held; 0 where nothing is counted
};

/// Who waits for an immediate computation.
struct Waiting {
  std::function<bool()> hung_up;  ///< may be empty: it waits as long as it takes
  /// Answers in place of a computation that does not stop; may be empty. `is_replaced`: what the computation holds of
  /// its caller is to be given to others too, for there are few such computations. Called from another thread, once at
  /// most, before run_now returns. It does not wait.
  std::function<void(const problem::Problem& problem, bool is_replaced)> answer_for_it{};
};

/// A job as a client sees it: its record, and how far it is.
struct JobStatus {
  store::JobRecord record;
  double progress = 0;  ///< in [0, 1]
  std::string stage;
  std::string partial{};      ///< JSON of an intermediate result while it runs; empty where there is none
  std::int64_t revision = 0;  ///< of what another server tells of it
};

struct QueueOptions {
  int workers = 2;                             ///< jobs that run at the same time
  int immediate = 4;                           ///< immediate computations that run at the same time
  std::size_t max_queue = 1000;                ///< jobs that wait for a worker; setting --max-queue
  std::int64_t max_queue_bytes = 256LL << 20;  ///< of memory that those hold; setting --max-queue-bytes
  double retention = 7 * 86400;                ///< seconds that a finished job is kept; setting --retention
  std::size_t max_jobs = 10'000;               ///< finished jobs that are kept; setting --max-jobs
  budget::MemoryBudget* memory = nullptr;      ///< that computations may fill; null: any amount
  int max_attempts = 3;                        ///< to run a job that the process ends in; setting --max-attempts
  std::function<void()> clean_up_too;          ///< called every minute by the cleaner, after what it does itself
};

/// What a job can be made again from after a restart. The body is the caller's.
struct RequestOfJob {
  store::JobRequest request;
  std::string_view body;
};

/// Runs computations: at once on the caller's thread, or as jobs on worker threads.
///
/// Jobs that come with their request outlive the process: they go on waiting, in their order, in the next one, with
/// their id, client and session, and their deadline counts anew from its start. So do those that ran, whether the
/// process was killed or told to end. One that the process ended in without being told to, in all of its
/// `max_attempts`, fails with "job.given_up"; its last attempt runs beside no other job's last attempt, so that of jobs
/// that ran together the one that ends the process is the only one that fails.
///
/// Problems of failed jobs are kept as the text that `render` makes of them. A job whose result cannot be stored fails
/// with the reason ("store.full", "store.unavailable"); where the store does not take that end either, it is held in
/// memory, for all who ask, and written as soon as the store takes it. All members may be called from any thread.
class JobQueue {
 public:
  using Render = std::function<std::string(const problem::Problem&)>;
  /// Hears of every finished job.
  using Observe = std::function<void(const store::JobRecord&)>;
  /// Hears what the store refused to keep, and which computations do not stop, as text for the log. Called from any
  /// thread.
  using Log = std::function<void(const std::string&)>;

  /// Makes a computation again from its request, which throws what a client would have been told. Called on a worker,
  /// for which `execution` is what the computation gets too: what has to be loaded for it hears of its stop.
  using Remake = std::function<Computation(const store::JobRecord&, store::StoredRequest, const Execution& execution)>;

  /// Jobs that an earlier process left unfinished wait again; without their request, or without `remake`, they become
  /// failed with "job.interrupted".
  JobQueue(store::Store& store, const QueueOptions& options, Render render, Observe observe, Log log = {},
           Remake remake = {});
  /// Shuts down without grace, and waits for workers of abandoned jobs.
  ~JobQueue();
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;

  /// Computes on this thread within a compute slot. Throws what the computation throws; "job.cancelled" once
  /// `waiting.hung_up` says so, "job.deadline_exceeded", "server.shutting_down". Leaves no trace in the store.
  /// `profile`, if there is one, is filled however it ends.
  ///
  /// A computation that goes on for Watchdog::patience after its deadline, or after its client has hung up, is
  /// abandoned: `waiting` is answered, and others get its slot while no more than `immediate` are abandoned. This
  /// returns when the computation does; its result is dropped then.
  store::Result run_now(const Computation& computation, Waiting waiting, Profile* profile = nullptr);

  /// Makes it a job that waits for a worker; it outlives the process if it comes with its request. Where there is a job
  /// with its key of idempotency already, it is that one. Throws "job.key_reused" where that was asked for something
  /// else, "job.queue_full", "job.client_queue_full", "server.shutting_down", "store.full", "store.quota",
  /// "store.unavailable".
  JobStatus submit(Computation computation, const std::optional<RequestOfJob>& request = {});

  /// Computes on a worker and waits: for the result, or for `seconds`, after which it has become a job that can be
  /// asked for, as after `submit`. Throws like run_now and submit; a client that hangs up while this waits cancels the
  /// computation.
  struct ResultOrJob {
    std::optional<store::Result> result;
    JobStatus job;
  };
  ResultOrJob run_within(Computation computation, double seconds, const std::function<bool()>& hung_up,
                         const std::optional<RequestOfJob>& request = {});

  /// Throws "job.not_found".
  JobStatus status(const std::string& id) const;
  /// The newest first, of an owner alone where one is named.
  std::vector<JobStatus> list(std::optional<store::JobState> state, std::size_t limit, const std::string& after,
                              const std::string& owner = {}) const;
  /// Throws "job.not_found", "job.not_finished" and "job.dismissed"; for a failed job there is none.
  store::StoredResult result(const std::string& id) const;
  /// Requests the stop of an unfinished job, which is dismissed at once, or removes a finished one. Returns the
  /// dismissed job, or nothing. Throws "job.not_found".
  std::optional<JobStatus> remove(const std::string& id);

  /// Waits until the job's status has changed since `version` (0: returns at once), or for `seconds`. Updates
  /// `version`.
  JobStatus wait_for_change(const std::string& id, std::uint64_t& version, double seconds) const;

  bool mesh_in_use(const std::string& mesh) const;
  std::size_t running() const;
  std::size_t waiting() const;
  int immediate() const { return slots_.in_use(); }
  /// Computations that do not stop and that nobody waits for any more.
  std::size_t abandoned() const;

  /// Refuses new computations, gives those that run `grace_seconds` to finish, then stops them. Jobs that did not run
  /// to their end wait for the next process, or fail with "job.interrupted" where it could not make them again. Returns
  /// once no worker runs but those of abandoned jobs, for which the destructor waits.
  void shut_down(double grace_seconds);

 private:
  struct Job;
  using JobPointer = std::shared_ptr<Job>;
  struct Worker {
    std::thread thread;
    JobPointer job{};                              // that it runs
    bool last_attempt = false;                     // of the job
    std::optional<Watchdog::Overdue> abandoned{};  // with the job: another worker is there in its place
  };

  /// An immediate computation.
  struct Immediate {
    CancellationToken token;
    std::optional<Watchdog::Overdue> abandoned{};
  };
  /// Returns whether others get what the computation of this ticket holds.
  bool abandon_immediate(std::uint64_t ticket, const Watchdog::Overdue& overdue);
  /// `whose` names the request or the job as log::Context does.
  void tell_abandoned(const std::string& whose, const Computation& computation, const Watchdog::Overdue& overdue) const;
  void tell_returned(const Computation& computation, const Watchdog::Overdue& overdue) const;

  /// Under the mutex: stops what else runs in the session and takes its place. Returns the number to leave it with.
  std::uint64_t enter_session(const std::string& session, const CancellationToken& token);
  void leave_session(const std::string& session, std::uint64_t number);
  /// Puts the jobs of an earlier process back into the queue.
  void resume();
  /// Under the mutex: a job that no process runs any more becomes one of this one.
  void take_over(store::JobRecord record);
  /// In a shared store: says what this server does, and takes jobs that others cannot run.
  void share();
  bool share_once();  // returns whether it took some
  /// For a job that the store says this server holds.
  void take_over_if_unknown(const std::string& id, std::int64_t hold);
  /// The status of a job that was asked for with the same key before. Throws "job.key_reused".
  std::optional<JobStatus> asked_before(const std::string& key, const std::string& request_hash) const;
  /// What runs a job again that an earlier process has accepted.
  Computation computation_again(const store::JobRecord& record);
  void fail_at_start(store::JobRecord record, const problem::Problem& problem);
  JobPointer make_job(Computation computation);
  /// A job with a request is visible to clients at once.
  JobPointer enqueue(Computation computation, const std::optional<RequestOfJob>& request, bool visible);
  /// Makes a job visible that was not until now, unless it finishes meanwhile.
  void make_visible(const JobPointer& job, const store::JobRecord& record, const std::optional<RequestOfJob>& request);
  /// Under the mutex: into the queue.
  void add(const JobPointer& job);
  /// Under the mutex: throws "job.queue_full" where there is no place for the job, "job.client_queue_full" where its
  /// client has its share of them.
  void require_place(const Computation& computation) const;
  /// Under the mutex: the job that a worker runs next, the first one of the client with the fewest that run; the end
  /// where none may run now.
  std::deque<JobPointer>::iterator next_place();
  JobPointer take_next();
  bool is_last_attempt(const Job& job) const;
  /// Keeps a job's request and calls `publish` with what the store's row takes of it; not under the mutex, for writing
  /// a request takes long. Drops it again where `publish` returns false: the job does not become visible.
  void with_request(const store::JobRecord& record, const std::optional<RequestOfJob>& request,
                    const std::function<bool(const std::string& kept)>& publish);
  /// Under the mutex. `kept`: so is its request, of which the row takes `request`.
  void publish(Job& job, bool kept, const std::string& request = {});
  void work(Worker& self);
  /// Under the mutex: another worker, which runs jobs as soon as it may.
  void add_worker();
  /// Jobs whose computation goes on for Watchdog::patience after their deadline, or after the client has hung up that
  /// waited for them, fail with that; the workers of those, and of jobs that were dismissed so long ago, are replaced
  /// while no more than `workers` are.
  void abandon_jobs();
  /// Under the mutex: since when the worker's computation should have stopped, where that is long ago.
  static std::optional<Watchdog::Overdue> overdue(const Worker& worker);
  /// Runs it on this thread and holds what it allocates against the budget. Throws what it throws, or why it had to be
  /// stopped: "request.too_much_memory", "server.out_of_memory".
  store::Result compute(const Computation& computation, const Execution& execution, Profile* profile = nullptr) const;
  void run_job(const JobPointer& job);
  /// Tells the store how often a job was begun; where that is refused the attempt does not count. False where another
  /// server has the job.
  bool note_progress(const store::JobRecord& record);
  /// Under the mutex: leaves a job to the next process.
  void put_back(const JobPointer& job);
  void finish(const JobPointer& job, store::JobState state, std::optional<store::Result> result,
              std::exception_ptr failure);
  /// Under the mutex: it is no job of this process any more.
  void forget(Job& job);
  /// Stops a job that another server has, or has dismissed.
  void lose(const JobPointer& job);
  std::int64_t retention_milliseconds() const { return static_cast<std::int64_t>(1000 * options_.retention); }
  enum class End { stored, refused, of_another_server };
  /// Stores how a job ended; what the store refuses becomes part of the record.
  End write_end(store::JobRecord& record, const store::Result* result);
  void write_what_was_refused();
  /// Under the mutex: the job that only this process can answer for; of a lost one the store knows more.
  JobPointer find(const std::string& id) const;
  /// Under the mutex: the status of what memory knows better than the store. In a shared store these are the
  /// jobs that run here, for another server may have taken, and ended, what waits.
  std::optional<JobStatus> status_in_memory(const std::string& id) const;
  static JobStatus status_of(const Job& job);
  JobStatus status_in_store(const store::JobRecord& record) const;
  void clean_up();

  store::Store& store_;
  const QueueOptions options_;
  const Render render_;
  const Observe observe_;
  const Log log_;
  const Remake remake_;
  Watchdog watchdog_;
  ComputeSlots slots_;

  mutable std::mutex mutex_;
  mutable std::condition_variable work_;  // for the workers: a job waits, or the end has come
  std::condition_variable end_;  // for the cleaner, which must not take a wake-up that a worker is meant to get
  mutable std::condition_variable changed_;  // a job's status has changed
  std::deque<JobPointer> queue_;
  std::int64_t queue_bytes_ = 0;                       // that the jobs in the queue hold
  std::map<std::string, int> running_of_;              // jobs of each client that run
  bool last_attempt_runs_ = false;                     // of one of the jobs
  double mean_seconds_ = 0;                            // that a job runs, a moving average
  std::map<std::string, JobPointer> jobs_;             // unfinished ones, those not yet visible to clients included
  std::map<std::string, store::JobRecord> unwritten_;  // finished ones whose end the store did not take
  std::map<std::uint64_t, Immediate> immediate_;
  std::size_t abandoned_immediate_ = 0;  // of them
  /// The latest unfinished computation of each session, with a number that tells it from later ones.
  std::map<std::string, std::pair<std::uint64_t, CancellationToken>> sessions_;
  std::uint64_t next_in_session_ = 0;
  std::uint64_t next_immediate_ = 0;
  std::size_t running_ = 0;         // jobs, those that are abandoned aside
  std::size_t abandoned_jobs_ = 0;  // whose workers are replaced
  bool refusing_ = false;
  bool ending_ = false;
  std::list<Worker> workers_;
  std::thread cleaner_;
  std::thread keeper_;  // of the holds on jobs in a shared store
};

/// 128 random bits from the system, hexadecimal.
std::string random_id();

}  // namespace supple::jobs
