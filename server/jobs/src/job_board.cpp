#include "job_board.h"

#include <algorithm>
#include <utility>

#include "supple/store/clock.h"

namespace supple::jobs {
namespace {

constexpr std::chrono::milliseconds progress_period{100};  // time between two published states of progress

}  // namespace

void Job::report(double fraction, std::string_view name) {
  const auto now = Clock::now();
  if (now - last_report < progress_period && last_report != Clock::time_point{}) return;
  last_report = now;
  board.set_progress(*this, fraction, name);
}

/// The latest result is noted even if it comes within the period. Clients then hear of it with the next report.
void Job::publish(std::string_view text) {
  const auto now = Clock::now();
  const bool notify = now - last_published >= progress_period;
  if (notify) last_published = now;
  board.set_partial(*this, text, notify);
}

void JobBoard::add(const JobPointer& job) {
  const std::lock_guard lock(mutex_);
  jobs_.emplace(job->id, job);
}

bool JobBoard::has(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  return jobs_.contains(id);
}

std::optional<store::JobRecord> JobBoard::begin_row(Job& job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return job.phase != Phase::ending; });
  if (is_over(job)) return std::nullopt;
  std::optional<store::JobRecord> record = job.record;  // before anything changes, since there may be no memory for it
  job.row = Row::being_written;
  return record;
}

void JobBoard::row_written(Job& job) {
  const std::lock_guard lock(mutex_);
  job.row = Row::written;
  changed_.notify_all();
}

bool JobBoard::row_failed(Job& job) {
  const std::lock_guard lock(mutex_);
  job.row = Row::none;
  job.token.request(StopReason::cancelled);
  if (!job.left_at) job.left_at = Clock::now();
  const bool waits = job.phase == Phase::queued;
  if (waits) forget(job, Phase::released);
  changed_.notify_all();
  return waits;
}

std::optional<JobBoard::Start> JobBoard::start(Job& job) {
  const std::lock_guard lock(mutex_);
  if (job.phase != Phase::queued) return std::nullopt;
  job.phase = Phase::starting;
  job.record.state = JobState::running;
  job.record.started = store::now_milliseconds();
  ++job.record.attempts;
  ++job.version;
  changed_.notify_all();
  if (job.row != Row::written) return Start{};
  return Start{job.record};
}

void JobBoard::set_running(Job& job) {
  const std::lock_guard lock(mutex_);
  if (job.phase == Phase::starting) job.phase = Phase::running;
}

std::optional<store::JobRecord> JobBoard::count_starts_anew(Job& job) {
  const std::lock_guard lock(mutex_);
  if (job.phase != Phase::running || job.record.attempts <= 1) return std::nullopt;
  job.record.attempts = 1;
  if (job.row != Row::written) return std::nullopt;
  return job.record;
}

void JobBoard::set_progress(Job& job, double fraction, std::string_view stage) {
  const std::lock_guard lock(mutex_);
  job.progress = std::clamp(fraction, job.progress, 1.0);
  job.stage = stage;
  ++job.version;
  changed_.notify_all();
}

void JobBoard::set_partial(Job& job, std::string_view partial, bool notify) {
  const std::lock_guard lock(mutex_);
  job.partial = partial;
  if (!notify) return;
  ++job.version;
  changed_.notify_all();
}

void JobBoard::set_client_left(Job& job) {
  job.token.request(StopReason::cancelled);
  const std::lock_guard lock(mutex_);
  if (!job.left_at) job.left_at = Clock::now();
}

std::optional<Watchdog::Overdue> JobBoard::overdue(const Job& job, Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  // Another thread stores its row or its end now.
  if (job.row == Row::being_written || job.phase == Phase::ending) return std::nullopt;
  const auto is_long_ago = [&](Clock::time_point since) { return now - since >= Watchdog::patience; };
  if (is_long_ago(std::max(job.due, job.resumed_at.load()))) return Watchdog::Overdue{StopReason::deadline, job.due};
  if (is_over(job) && is_long_ago(job.ended_at)) return Watchdog::Overdue{StopReason::cancelled, job.ended_at};
  if (job.left_at && is_long_ago(*job.left_at)) return Watchdog::Overdue{StopReason::cancelled, *job.left_at};
  return std::nullopt;
}

std::optional<JobBoard::Claim> JobBoard::claim_end(Job& job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return job.row != Row::being_written && job.phase != Phase::ending; });
  return begin_end(job);
}

std::optional<JobBoard::Claim> JobBoard::try_claim_end(Job& job) {
  const std::lock_guard lock(mutex_);
  if (job.row == Row::being_written) return std::nullopt;
  return begin_end(job);
}

std::optional<JobBoard::Claim> JobBoard::begin_end(Job& job) {
  if (job.phase == Phase::ending || is_over(job)) return std::nullopt;
  std::optional<Claim> claim = Claim{job.record, job.row == Row::written};  // before anything changes, as in begin_row
  job.phase = Phase::ending;
  return claim;
}

void JobBoard::complete(Job& job, store::JobRecord record, std::optional<Result> result, std::exception_ptr failure) {
  const std::lock_guard lock(mutex_);
  job.record = std::move(record);
  job.result = std::move(result);
  job.failure = std::move(failure);
  forget(job, Phase::ended);
}

void JobBoard::release(Job& job) {
  const std::lock_guard lock(mutex_);
  forget(job, Phase::released);
}

void JobBoard::forget(Job& job, Phase phase) {
  job.phase = phase;
  job.ended_at = Clock::now();
  jobs_.erase(job.id);
  changed_.notify_all();
}

bool JobBoard::has_ended(const Job& job) const {
  const std::lock_guard lock(mutex_);
  return job.phase == Phase::ended;
}

bool JobBoard::wait_until_over(const Job& job, Clock::time_point end) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, end, [&] { return is_over(job); });
}

JobPointer JobBoard::find_job(const std::string& id) const {
  const auto found = jobs_.find(id);
  return found == jobs_.end() || found->second->row == Row::none ? nullptr : found->second;
}

JobPointer JobBoard::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  return find_job(id);
}

JobStatus JobBoard::status_of(const Job& job) const {
  const std::lock_guard lock(mutex_);
  return status(job);
}

std::optional<JobStatus> JobBoard::status_in_memory(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto job = find_job(id);
  if (!job || (is_store_shared_ && job->phase != Phase::running)) return std::nullopt;
  return status(*job);
}

std::optional<JobStatus> JobBoard::wait_for_change(const Job& job, std::uint64_t& version, double seconds) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, duration(seconds), [&] { return is_over(job) || job.version != version; });
  if (is_over(job)) return std::nullopt;
  version = job.version;
  return status(job);
}

bool JobBoard::is_mesh_in_use(const std::string& mesh) const {
  const std::lock_guard lock(mutex_);
  return std::any_of(jobs_.begin(), jobs_.end(), [&](const auto& entry) { return entry.second->record.mesh == mesh; });
}

std::vector<JobBoard::LeasedJob> JobBoard::leased_jobs() const {
  const std::lock_guard lock(mutex_);
  std::vector<LeasedJob> leased;
  for (const auto& [id, job] : jobs_) {
    if (job->row != Row::written) continue;
    leased.push_back({job, job->record.fencing_token, job->version, std::nullopt});
    if (job->record.state == JobState::running && job->version != job->shared_version)
      leased.back().progress = store::JobProgress{id, job->progress, job->stage, job->partial};
  }
  return leased;
}

void JobBoard::stop_all(StopReason reason) {
  const std::lock_guard lock(mutex_);
  for (const auto& [id, job] : jobs_) job->token.request(reason);
}

}  // namespace supple::jobs
