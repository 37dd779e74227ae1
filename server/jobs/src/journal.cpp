#include "journal.h"

#include <utility>
#include <vector>

#include "supple/log/context.h"
#include "supple/store/clock.h"
#include "supple/store/store_error.h"

namespace supple::jobs {

Journal::Journal(store::Store& store, const QueueOptions& options, JobQueue::Render render, JobQueue::Log log)
    : store_(store), options_(options), render_(std::move(render)), log_(std::move(log)) {}

void Journal::add(const store::JobRecord& record, const std::optional<RequestOfJob>& request) {
  const auto stored = request ? store_.blobs().store_request(record, request->request, request->body) : std::string();
  try {
    if (!store_.jobs().add_job(record, stored)) throw KeyIsUsed();
  } catch (...) {
    if (request) store_.blobs().remove_request(record.id);
    throw;
  }
}

bool Journal::update(const store::JobRecord& record) {
  try {
    return store_.jobs().update_job(record);
  } catch (...) {
    return true;
  }
}

std::int64_t Journal::expiry(std::int64_t finished) const {
  return finished + static_cast<std::int64_t>(1000 * options_.retention);
}

void Journal::set_end(store::JobRecord& record, JobState state, const std::optional<problem::Problem>& problem) const {
  record.state = state;
  record.finished = store::now_milliseconds();
  record.expires = expiry(record.finished);
  if (problem) set_error(record, *problem);
}

void Journal::set_error(store::JobRecord& record, const problem::Problem& problem) const {
  record.error = render_(problem);
  record.error_status = problem::status_of(problem);
}

bool Journal::end(store::JobRecord& record, const Result* result) {
  auto written = write_end(record, result);
  // A store without room for the result often has room for the reason of the failure.
  if (written == Written::refused && result) written = write_end(record, nullptr);
  if (written == Written::refused) {
    const std::lock_guard lock(mutex_);
    refused_ends_.insert_or_assign(record.id, record);
  }
  return written != Written::of_another_server;
}

Journal::Written Journal::write_end(store::JobRecord& record, const Result* result) {
  const bool is_shared = store_.leases() != nullptr;
  try {
    return store_.jobs().finish_job(record, result) || !is_shared ? Written::stored : Written::of_another_server;
  } catch (const store::StoreUnavailable&) {
    // Once the lease of this server has ended, this or another server runs the job again.
    return is_shared ? Written::of_another_server : refused_by_store(record, result);
  } catch (...) {
    return refused_by_store(record, result);
  }
}

/// Tells why the store did not take an end. Called while the exception is handled that says so.
Journal::Written Journal::refused_by_store(store::JobRecord& record, const Result* result) const {
  const auto problem = problem::problem_of(std::current_exception());
  if (log_) log_("the end of job " + record.id + " cannot be stored: " + problem.detail);
  if (result) {
    record.state = JobState::failed;
    set_error(record, problem);
  }
  return Written::refused;
}

void Journal::write_refused_ends() {
  std::vector<store::JobRecord> records;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, record] : refused_ends_) records.push_back(record);
  }
  for (const auto& record : records) {
    const log::Context context("job", record.id);
    try {
      store_.jobs().finish_job(record, nullptr);
    } catch (...) {
      return;  // the first refusal was logged, and the store would refuse the other ends too
    }
    if (log_) log_("the end of job " + record.id + " is stored now");
    forget_refused_end(record.id);
  }
}

std::optional<store::JobRecord> Journal::refused_end(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = refused_ends_.find(id);
  return found == refused_ends_.end() ? std::nullopt : std::optional(found->second);
}

bool Journal::has_refused_ends() const {
  const std::lock_guard lock(mutex_);
  return !refused_ends_.empty();
}

void Journal::forget_refused_end(const std::string& id) {
  const std::lock_guard lock(mutex_);
  refused_ends_.erase(id);
}

}  // namespace supple::jobs
