// How jobs end: what becomes of their results, where the store takes them and where it does not.

#include <utility>
#include <vector>

#include "job.h"
#include "supple/log/context.h"

namespace supple::jobs {

void JobQueue::fail_at_start(store::JobRecord record, const problem::Problem& problem) {
  record.state = JobState::failed;
  record.finished = store::now_milliseconds();
  record.expires = record.finished + retention_milliseconds();
  record.error = render_(problem);
  record.error_status = problem::status_of(problem);
  const log::Context context("job", record.id);
  if (write_end(record, nullptr) == End::refused) unwritten_.emplace(record.id, record);
}

void JobQueue::finish(const JobPointer& job, JobState state, std::optional<Result> result, std::exception_ptr failure) {
  std::unique_lock lock(mutex_);
  if (job->finishing) {
    changed_.wait(lock, [&] { return job->finished; });
    return;
  }
  job->finishing = true;
  if (job->dismissed) {
    // Also where the computation ended before the client's thread got here.
    state = JobState::dismissed;
    failure = nullptr;
    result.reset();
  }
  if (failure && job->kept && problem::problem_of(failure).code == stopped_by_shutdown) {
    put_back(job);
    return;
  }
  if (job->lost) {
    forget(*job);
    return;
  }
  auto record = job->record;
  record.state = state;
  record.finished = store::now_milliseconds();
  record.expires = record.finished + retention_milliseconds();
  if (failure) {
    auto problem = problem::problem_of(failure);
    if (problem.code == stopped_by_shutdown) problem = interrupted();
    record.error = render_(problem);
    record.error_status = problem::status_of(problem);
  }
  auto written = End::stored;
  if (job->visible) {
    // Disk work without the mutex; until it is done the job counts as unfinished.
    lock.unlock();
    written = write_end(record, result ? &*result : nullptr);
    lock.lock();
  }
  if (written == End::of_another_server) {
    job->lost = true;
    forget(*job);
    return;
  }
  if (written == End::refused) unwritten_.insert_or_assign(record.id, record);
  // Not what names the job, which a worker reads without the mutex, and goes on reading where it was abandoned.
  job->record.state = record.state;
  job->record.finished = record.finished;
  job->record.expires = record.expires;
  job->record.error = record.error;
  job->record.error_status = record.error_status;
  job->finished = true;
  job->ended_at = Clock::now();
  job->result = std::move(result);
  job->failure = failure;
  jobs_.erase(record.id);
  leave_session(job->computation.session, job->in_session);
  changed_.notify_all();
  auto watch = std::move(job->watch);
  lock.unlock();
  watch.reset();
  observe_(record);
}

void JobQueue::put_back(const JobPointer& job) {
  auto& record = job->record;
  if (record.state == JobState::running) {
    record.state = JobState::accepted;
    record.started = 0;
    --record.attempts;
  }
  note_progress(record);  // also of one that waits: in a shared store another server may have it now
  forget(*job);
}

void JobQueue::forget(Job& job) {
  job.finished = true;
  job.ended_at = Clock::now();
  jobs_.erase(job.record.id);
  leave_session(job.computation.session, job.in_session);
  changed_.notify_all();
  job.watch.reset();
}

void JobQueue::lose(const JobPointer& job) {
  {
    const std::lock_guard lock(mutex_);
    if (job->finishing) return;  // that is why the database does not name it any more
    job->lost = true;
  }
  job->token.request(StopReason::cancelled);
  finish(job, JobState::failed, std::nullopt, nullptr);
}

JobQueue::End JobQueue::write_end(store::JobRecord& record, const Result* result) {
  try {
    return store_.finish_job(record, result) || !store_.is_shared() ? End::stored : End::of_another_server;
  } catch (...) {
    const auto problem = problem::problem_of(std::current_exception());
    // Other servers have the job once its hold has ended, or this one has it again: it is run once more.
    if (store_.is_shared() && problem.code == "store.unavailable") return End::of_another_server;
    if (log_) log_("the end of job " + record.id + " cannot be stored: " + problem.detail);
    if (!result) return End::refused;
    record.state = JobState::failed;
    record.error = render_(problem);
    record.error_status = problem::status_of(problem);
  }
  // Where the result does not fit, the reason often does.
  return write_end(record, nullptr);
}

void JobQueue::write_what_was_refused() {
  std::vector<store::JobRecord> records;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, record] : unwritten_) records.push_back(record);
  }
  for (const auto& record : records) {
    const log::Context context("job", record.id);
    try {
      store_.finish_job(record, nullptr);
    } catch (const Error&) {
      return;  // said when it was refused first; the others have no better chance
    }
    if (log_) log_("the end of job " + record.id + " is stored now");
    const std::lock_guard lock(mutex_);
    unwritten_.erase(record.id);
  }
}

}  // namespace supple::jobs
