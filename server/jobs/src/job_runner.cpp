#include "job_runner.h"

#include <exception>
#include <string>
#include <utility>

#include "run_computation.h"
#include "supple/base/background_threads.h"
#include "supple/log/context.h"
#include "supple/store/clock.h"

namespace supple::jobs {
namespace {

problem::Problem interrupted() {
  return {"job.interrupted", "The server stopped before the job had finished.", {}, {}, {}};
}

problem::Problem given_up(int attempts, int limit) {
  return {"job.given_up",
          "The server ended " + std::to_string(attempts) + " times while this job ran; it is not run again (setting " +
              "--max-attempts).",
          {},
          problem::Limit{static_cast<double>(limit), static_cast<double>(attempts), "--max-attempts"},
          {}};
}

/// Whether a computation ended because this process ends. Whatever else it throws is its own failure.
bool is_stopped_by_shutdown(const std::exception_ptr& failure) {
  if (!failure) return false;
  try {
    std::rethrow_exception(failure);
  } catch (const Cancelled& stop) {
    return stop.reason() == StopReason::shutdown;
  } catch (...) {
    return false;
  }
}

}  // namespace

JobRunner::JobRunner(store::Store& store, const QueueOptions& options, Watchdog& watchdog, JobBoard& board,
                     Scheduler& scheduler, Journal& journal, const AbandonmentLog& abandonment_log, JobQueue::Log log,
                     JobQueue::Observe observe, JobQueue::Remake remake)
    : store_(store),
      options_(options),
      watchdog_(watchdog),
      board_(board),
      scheduler_(scheduler),
      journal_(journal),
      abandonment_log_(abandonment_log),
      log_(std::move(log)),
      observe_(std::move(observe)),
      remake_(std::move(remake)) {}

JobRunner::~JobRunner() {
  scheduler_.end();
  for (auto& worker : workers_)
    if (worker.thread.joinable()) worker.thread.join();
}

JobPointer JobRunner::make_job(Computation computation, bool has_request, Row row) const {
  store::JobRecord record;
  record.id = store::random_id();
  record.kind = computation.kind;
  record.mesh = computation.mesh;
  record.created = store::now_milliseconds();
  record.deadline = computation.deadline;
  record.client = computation.client;
  record.session = computation.session;
  record.owner = computation.owner;
  record.idempotency_key = computation.idempotency_key;
  record.request_hash = computation.request_hash;
  record.priority = computation.priority;
  record.families = computation.families;
  return std::make_shared<Job>(board_, watchdog_, std::move(computation), std::move(record), has_request, row);
}

void JobRunner::take_over(store::JobRecord record) {
  std::optional<problem::Problem> problem;
  if (!remake_ || !store_.blobs().has_request(record.id)) {
    problem = interrupted();
  } else if (record.state == JobState::running && record.attempts >= options_.max_attempts) {
    problem = given_up(record.attempts, options_.max_attempts);
  }
  if (problem) {
    const log::Context context("job", record.id);
    journal_.set_end(record, JobState::failed, problem);
    journal_.end(record, nullptr);
    return;
  }
  record.state = JobState::accepted;
  record.started = 0;
  auto computation = computation_again(record);
  scheduler_.adopt(
      std::make_shared<Job>(board_, watchdog_, std::move(computation), std::move(record), true, Row::written));
}

/// The request is read once a worker has the job. Until then it takes no memory, and a fault of the request counts as
/// an attempt.
Computation JobRunner::computation_again(const store::JobRecord& record) {
  Computation computation{record.kind, record.mesh, record.deadline, {}, record.session, record.client};
  computation.priority = record.priority;
  computation.run = [this, record](const Execution& execution) {
    auto request = store_.blobs().job_request(record.id);
    return remake_(record, std::move(request), execution).run(execution);
  };
  return computation;
}

void JobRunner::work(Scheduler::Seat& seat) {
  while (const auto task = scheduler_.take(seat)) {
    const auto& job = task->job;
    if (const auto failure = try_step(*job, [&] { run(*task, seat); }))
      try_step(*job, [&] { end(job, JobState::failed, std::nullopt, failure); });  // if it has not ended yet
    if (const auto abandoned = scheduler_.leave(seat))
      try_step(*job, [&] { abandonment_log_.note_returned(job->computation, *abandoned); });
  }
}

template <typename Step>
std::exception_ptr JobRunner::try_step(const Job& job, const Step& step) const noexcept {
  std::exception_ptr failure;
  try {
    const log::Context context("job", job.id);
    try {
      step();
    } catch (const std::exception& error) {
      failure = std::current_exception();
      if (log_) log_(std::string("the server met an error at this job: ") + error.what());
    }
  } catch (...) {
    // There may be no memory for the line.
    if (!failure) failure = std::current_exception();
  }
  return failure;
}

void JobRunner::run(const Scheduler::Task& task, Scheduler::Seat& seat) {
  const auto& job = task.job;
  if (task.record && !journal_.update(*task.record)) {
    lose(job);
    return;
  }
  board_.set_running(*job);
  std::optional<Result> result;
  std::exception_ptr failure;
  try {
    job->token.throw_if_requested();
    Execution execution;
    execution.cancellation = job->token;
    execution.progress = job.get();
    job->on_saved = [&] {
      // A job that the store does not name any more is stopped by the keeper of leases.
      if (const auto record = board_.count_starts_anew(*job)) (void)journal_.update(*record);
    };
    result = run_computation(job->computation, execution, options_.memory);
  } catch (...) {
    failure = std::current_exception();
  }
  scheduler_.set_computed(seat);
  end(job, failure ? JobState::failed : JobState::successful, std::move(result), failure);
}

void JobRunner::end(const JobPointer& job, JobState state, std::optional<Result> result, std::exception_ptr failure) {
  auto claim = board_.claim_end(*job);
  if (!claim) return;
  if (state == JobState::dismissed) job->token.request(StopReason::cancelled);
  scheduler_.forget(*job);
  bool is_ended = false;
  try {
    is_ended = store_end(job, *claim, state, std::move(result), std::move(failure));
  } catch (...) {
    // Nobody may go on waiting for its end. If it has a row, the next process runs it again.
    if (claim->has_row) {
      board_.release(*job);
    } else {
      board_.complete(*job, std::move(claim->record), std::nullopt, std::current_exception());
    }
    throw;
  }
  if (!is_ended) board_.release(*job);
  job->watch.reset();
  if (is_ended) observe_(claim->record);
}

bool JobRunner::store_end(const JobPointer& job, JobBoard::Claim& claim, JobState state, std::optional<Result> result,
                          std::exception_ptr failure) {
  auto& record = claim.record;
  std::optional<problem::Problem> problem;
  if (failure) problem = problem::problem_of(failure);
  if (is_stopped_by_shutdown(failure)) {
    if (claim.has_row && job->has_request) {
      if (record.state == JobState::running) {
        record.state = JobState::accepted;
        record.started = 0;
        --record.attempts;
      }
      journal_.update(record);  // also for a job that waits: in a shared store, another server may take it now
      return false;
    }
    problem = interrupted();
  }
  journal_.set_end(record, state, problem);
  if (claim.has_row && !journal_.end(record, result ? &*result : nullptr)) return false;
  board_.complete(*job, record, std::move(result), std::move(failure));
  return true;
}

bool JobRunner::dismiss(const JobPointer& job) {
  end(job, JobState::dismissed, std::nullopt, nullptr);
  return board_.has_ended(*job);
}

void JobRunner::lose(const JobPointer& job) {
  if (!board_.try_claim_end(*job)) return;  // it ends, which may be why the store does not name it any more
  job->token.request(StopReason::cancelled);
  scheduler_.forget(*job);
  board_.release(*job);
  job->watch.reset();
}

void JobRunner::end_stopped(const JobPointer& job) {
  try_step(*job, [&] { end(job, JobState::failed, std::nullopt, failure_of_stop(job->token.reason())); });
}

void JobRunner::add_workers() {
  add_workers(WorkerKind::foreground);
  add_workers(WorkerKind::background);
}

void JobRunner::add_workers(WorkerKind kind) {
  for (auto missing = scheduler_.missing_workers(kind); missing > 0; --missing) {
    auto& worker = workers_.emplace_back(Worker{scheduler_.add_seat(kind)});
    try {
      worker.thread = std::thread([this, &seat = worker.seat] {
        if (seat.kind == WorkerKind::background) become_background_thread();
        work(seat);
      });
    } catch (...) {
      scheduler_.remove_seat(worker.seat);
      workers_.pop_back();
      throw;
    }
  }
}

void JobRunner::abandon_late_jobs() {
  const auto late = scheduler_.abandon_late_jobs();
  try {
    add_workers();
  } catch (...) {
    // The system gives no further thread, or no memory, now. Jobs wait for the workers that there are.
  }
  for (const auto& one : late)
    if (one.is_abandoned)
      try_step(*one.job, [&] { abandonment_log_.note_abandoned({}, one.job->computation, one.since); });
  for (const auto& one : late)
    try_step(*one.job, [&] { end(one.job, JobState::failed, std::nullopt, failure_of_stop(one.since.reason)); });
}

void JobRunner::end_workers() {
  scheduler_.end();
  for (auto& worker : workers_)
    if (worker.thread.joinable() && !scheduler_.is_abandoned(worker.seat)) worker.thread.join();
}

}  // namespace supple::jobs
