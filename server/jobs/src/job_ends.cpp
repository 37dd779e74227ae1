// How jobs end: what becomes of their results, where the store takes them and where it does not.

#include <utility>
#include <vector>

#include "job.h"
#include "supple/log/context.h"

namespace supple::jobs {

void JobQueue::fail_at_start(store::JobRecord record, const problem::Problem& problem) {
  record.state = JobState::failed;
  record.finished = store::now_milliseconds();
  record.expires = record.finished + static_cast<std::int64_t>(1000 * options_.retention);
  record.error = render_(problem);
  record.error_status = problem::status_of(problem);
  const log::Context context("job", record.id);
  if (!write_end(record, nullptr)) unwritten_.emplace(record.id, record);
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
  auto record = job->record;
  record.state = state;
  record.finished = store::now_milliseconds();
  record.expires = record.finished + static_cast<std::int64_t>(1000 * options_.retention);
  if (failure) {
    auto problem = problem::problem_of(failure);
    if (problem.code == stopped_by_shutdown) problem = interrupted();
    record.error = render_(problem);
    record.error_status = problem::status_of(problem);
  }
  bool written = true;
  if (job->visible) {
    // Disk work without the mutex; until it is done the job counts as unfinished.
    lock.unlock();
    written = write_end(record, result ? &*result : nullptr);
    lock.lock();
  }
  if (!written) unwritten_.insert_or_assign(record.id, record);
  job->record = record;
  job->finished = true;
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
    note_progress(record);
  }
  job->finished = true;
  jobs_.erase(record.id);
  leave_session(job->computation.session, job->in_session);
  changed_.notify_all();
  job->watch.reset();
}

bool JobQueue::write_end(store::JobRecord& record, const Result* result) {
  try {
    store_.finish_job(record, result);
    return true;
  } catch (...) {
    const auto problem = problem::problem_of(std::current_exception());
    if (log_) log_("the end of job " + record.id + " cannot be stored: " + problem.detail);
    if (!result) return false;
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
