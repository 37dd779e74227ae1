#include "admission.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "run_computation.h"

namespace supple::jobs {

JobStatus Admission::submit(Computation computation, const std::optional<RequestOfJob>& request) {
  if (auto known = job_of_key(computation.idempotency_key, computation.request_hash)) return *std::move(known);
  const auto job = runner_.make_job(std::move(computation), request.has_value(), Row::being_written);
  const auto record = job->record;  // before other threads know the job
  scheduler_.admit(job);
  return write_row(job, record, request);
}

JobQueue::ResultOrJob Admission::run_within(Computation computation, double seconds,
                                            const std::function<bool()>& hung_up,
                                            const std::optional<RequestOfJob>& request) {
  constexpr std::chrono::milliseconds check_interval{20};  // time between two checks whether the client has hung up
  const auto end = Clock::now() + duration(seconds);
  if (auto known = job_of_key(computation.idempotency_key, computation.request_hash))
    return {std::nullopt, *std::move(known)};
  const auto job = runner_.make_job(std::move(computation), request.has_value(), Row::none);
  scheduler_.admit(job);
  while (Clock::now() < end && !board_.wait_until_over(*job, std::min(end, Clock::now() + check_interval)))
    if (hung_up && hung_up()) board_.set_client_left(*job);
  scheduler_.pause(*job);
  if (const auto record = begin_row(job)) return {std::nullopt, write_row(job, *record, request)};
  // The job is over, so that no other thread changes these members.
  if (job->failure) std::rethrow_exception(job->failure);
  return {charge_request(*std::move(job->result)), {}};
}

Result Admission::run_in_background(Computation computation, const std::function<bool()>& hung_up, Profile* profile) {
  // Written by the worker before the job is over, and by nobody if the job has never begun.
  const auto noted = std::make_shared<Profile>();
  computation.run = [run = std::move(computation.run), noted, accepted = Clock::now()](const Execution& execution) {
    const auto begin = Clock::now();
    noted->waited = std::chrono::duration<double>(begin - accepted).count();
    auto result = run(execution);
    noted->computed = std::chrono::duration<double>(Clock::now() - begin).count();
    return result;
  };
  constexpr double forever = 1e9;  // seconds; the job ends at its deadline
  auto outcome = run_within(std::move(computation), forever, hung_up, {});
  if (profile) *profile = *noted;
  return *std::move(outcome.result);
}

std::optional<JobStatus> Admission::job_of_key(const std::string& key, const std::string& request_hash) const {
  if (key.empty()) return std::nullopt;
  const auto known = store_.job_of_key(key);
  if (!known) return std::nullopt;
  if (known->request_hash != request_hash)
    throw Error("job.key_reused", "The Idempotency-Key of this request was used for another request before.");
  return reader_.status(known->id);
}

JobStatus Admission::write_row(const JobPointer& job, const store::JobRecord& record,
                               const std::optional<RequestOfJob>& request) {
  try {
    add_to_journal(job, record, request);
  } catch (const KeyIsUsed&) {
    if (auto known = job_of_key(record.idempotency_key, record.request_hash)) return *std::move(known);
    throw;
  }
  return board_.status_of(*job);
}

std::optional<store::JobRecord> Admission::begin_row(const JobPointer& job) {
  try {
    return board_.begin_row(*job);
  } catch (...) {
    leave_without_row(job);
    throw;
  }
}

void Admission::leave_without_row(const JobPointer& job) {
  if (!board_.row_failed(*job)) return;
  scheduler_.forget(*job);
  job->watch.reset();
}

void Admission::add_to_journal(const JobPointer& job, const store::JobRecord& record,
                               const std::optional<RequestOfJob>& request) {
  try {
    journal_.add(record, request);
  } catch (...) {
    leave_without_row(job);
    throw;
  }
  // The store has the job, so that it has to run, even if there is no memory for its session.
  struct GoOn {
    JobBoard& board;
    Scheduler& scheduler;
    Job& job;
    ~GoOn() {
      board.row_written(job);
      scheduler.resume(job);
    }
  } const go_on{board_, scheduler_, *job};
  if (job->number_in_session == 0) scheduler_.enter_session(*job);
}

}  // namespace supple::jobs
