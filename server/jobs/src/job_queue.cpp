#include "supple/jobs/job_queue.h"

#include <utility>

#include "admission.h"
#include "cleaner.h"
#include "immediate_runner.h"
#include "job_reader.h"
#include "job_runner.h"
#include "lease_keeper.h"
#include "supple/base/repeating_thread.h"
#include "supple/store/clock.h"

namespace supple::jobs {

/// The parts of the queue. A part may use those that are declared before it.
struct JobQueue::Parts {
  Parts(store::Store& the_store, const QueueOptions& the_options, Render render, Observe observe, const Log& log,
        Remake remake)
      : store(the_store),
        options(the_options),
        watchdog([this] {
          if (options.memory) options.memory->relieve();
        }),
        board(store.leases() != nullptr),
        scheduler(options, board, sessions),
        journal(store, options, std::move(render), log),
        abandonment_log(log, [this] { return abandoned(); }),
        immediate(options, watchdog, sessions, abandonment_log),
        runner(store, options, watchdog, board, scheduler, journal, abandonment_log, log, std::move(observe),
               std::move(remake)),
        reader(store, board, journal),
        admission(store.jobs(), board, scheduler, journal, runner, reader),
        cleaner(store, options, scheduler, runner, journal) {
    for (auto record : store.jobs().unfinished_jobs()) runner.take_over(std::move(record));
    runner.add_workers();
    cleaner_thread.emplace(
        "the cleaner", [this] { return cleaner.clean_up(); }, log);
    if (auto* const leases = store.leases()) {
      lease_keeper.emplace(*leases, store.jobs(), board, scheduler, journal, runner, log);
      keeper_thread.emplace(
          "the keeper of leases", [this] { return lease_keeper->renew(); }, log);
    }
  }

  std::size_t abandoned() const { return immediate.abandoned() + scheduler.abandoned(); }

  store::Store& store;
  const QueueOptions options;
  Watchdog watchdog;
  Sessions sessions;
  JobBoard board;
  Scheduler scheduler;
  Journal journal;
  AbandonmentLog abandonment_log;
  ImmediateRunner immediate;
  JobRunner runner;
  JobReader reader;
  Admission admission;
  Cleaner cleaner;
  std::optional<LeaseKeeper> lease_keeper;  // set if servers share the store
  std::optional<RepeatingThread> cleaner_thread;
  std::optional<RepeatingThread> keeper_thread;
};

JobQueue::JobQueue(store::Store& store, const QueueOptions& options, Render render, Observe observe, const Log& log,
                   Remake remake)
    : parts_(std::make_unique<Parts>(store, options, std::move(render), std::move(observe), log, std::move(remake))) {}

JobQueue::~JobQueue() { shut_down(0); }

store::Result JobQueue::run_now(const Computation& computation, Waiting waiting, Profile* profile) {
  if (computation.priority == Priority::background)
    return parts_->admission.run_in_background(computation, waiting.hung_up, profile);
  return parts_->immediate.run(computation, std::move(waiting), profile);
}

JobStatus JobQueue::submit(Computation computation, const std::optional<RequestOfJob>& request) {
  return parts_->admission.submit(std::move(computation), request);
}

JobQueue::ResultOrJob JobQueue::run_within(Computation computation, double seconds,
                                           const std::function<bool()>& hung_up,
                                           const std::optional<RequestOfJob>& request) {
  return parts_->admission.run_within(std::move(computation), seconds, hung_up, request);
}

JobStatus JobQueue::status(const std::string& id) const { return parts_->reader.status(id); }

std::vector<JobStatus> JobQueue::list(std::optional<JobState> state, std::size_t limit, const std::string& after,
                                      const std::string& owner) const {
  return parts_->reader.list(state, limit, after, owner);
}

store::StoredResult JobQueue::result(const std::string& id) const { return parts_->reader.result(id); }

JobStatus JobQueue::wait_for_change(const std::string& id, std::uint64_t& version, double seconds) const {
  return parts_->reader.wait_for_change(id, version, seconds);
}

std::optional<JobStatus> JobQueue::remove(const std::string& id) {
  auto& parts = *parts_;
  if (const auto job = parts.board.find(id); job && parts.runner.dismiss(job)) return status(id);
  // It has ended before, or it belongs to the next process or to another server.
  if (auto* const leases = parts.store.leases()) {
    const auto now = store::now_milliseconds();
    if (const auto record = leases->dismiss_job(id, now, parts.journal.expiry(now))) return JobStatus{*record, 0, {}};
  }
  if (!parts.store.jobs().remove_job(id)) throw_not_found(id);
  parts.journal.forget_refused_end(id);
  return std::nullopt;
}

bool JobQueue::mesh_in_use(const std::string& mesh) const { return parts_->reader.is_mesh_in_use(mesh); }
std::size_t JobQueue::running() const { return parts_->scheduler.running(); }
std::size_t JobQueue::waiting() const { return parts_->scheduler.waiting(); }
std::size_t JobQueue::waiting(Priority priority) const { return parts_->scheduler.waiting(priority); }
int JobQueue::immediate() const { return parts_->immediate.in_use(); }
std::size_t JobQueue::abandoned() const { return parts_->abandoned(); }

void JobQueue::shut_down(double grace_seconds) {
  auto& parts = *parts_;
  parts.scheduler.refuse();
  parts.immediate.refuse();
  const auto end = Clock::now() + duration(grace_seconds);
  parts.scheduler.wait_until_idle(end);
  parts.immediate.wait_until_idle(end);
  parts.board.stop_all(StopReason::shutdown);
  parts.immediate.stop_all();
  parts.scheduler.wait_until_idle(std::nullopt);
  parts.scheduler.end();
  parts.cleaner_thread.reset();
  parts.keeper_thread.reset();
  parts.runner.end_workers();
  for (const auto& job : parts.scheduler.waiting_jobs()) parts.runner.end_stopped(job);
  parts.journal.write_refused_ends();
}

}  // namespace supple::jobs
