// What the queue tells of its jobs.

#include <limits>
#include <utility>
#include <vector>

#include "job.h"

namespace supple::jobs {
namespace {

constexpr std::chrono::milliseconds look_at_other_servers{200};

}  // namespace

JobQueue::JobPointer JobQueue::find(const std::string& id) const {
  const auto found = jobs_.find(id);
  if (found == jobs_.end() || !found->second->visible || found->second->lost) return nullptr;
  return found->second;
}

std::optional<JobStatus> JobQueue::status_in_memory(const std::string& id) const {
  if (const auto job = find(id); job && (!store_.is_shared() || (job->runs_here && !job->finishing)))
    return status_of(*job);
  if (const auto end = unwritten_.find(id); end != unwritten_.end()) return JobStatus{end->second, 0, {}};
  return std::nullopt;
}

JobStatus JobQueue::status_of(const Job& job) { return {job.record, job.progress, job.stage, job.partial}; }

JobStatus JobQueue::status(const std::string& id) const {
  {
    const std::lock_guard lock(mutex_);
    if (auto status = status_in_memory(id)) return *std::move(status);
  }
  const auto record = store_.job(id);
  if (!record) throw_not_found(id);
  return status_in_store(*record);
}

JobStatus JobQueue::status_in_store(const store::JobRecord& record) const {
  JobStatus status{record, record.state == JobState::successful ? 1.0 : 0.0, {}};
  if (record.state != JobState::running) return status;
  if (auto progress = store_.job_progress(record.id)) {
    status.progress = progress->fraction;
    status.stage = std::move(progress->stage);
    status.partial = std::move(progress->partial);
    status.revision = progress->revision;
  }
  return status;
}

std::vector<JobStatus> JobQueue::list(std::optional<JobState> state, std::size_t limit, const std::string& after,
                                      const std::string& owner) const {
  // The store may know a running job as accepted; both are looked for together and told apart in memory. Those whose
  // end it did not take it knows as unfinished: while there are any, only memory tells the states.
  std::vector<JobStatus> list;
  std::vector<JobState> in_store;
  if (state) in_store = is_finished(*state) ? std::vector{*state} : std::vector{JobState::accepted, JobState::running};
  {
    const std::lock_guard lock(mutex_);
    if (!unwritten_.empty()) in_store.clear();
  }
  std::string last = after;
  while (list.size() < limit) {
    const auto page = store_.jobs(in_store, limit, last, owner);
    for (const auto& record : page) {
      auto status = status_in_store(record);
      {
        const std::lock_guard lock(mutex_);
        if (auto newer = status_in_memory(record.id)) status = *std::move(newer);
      }
      if ((!state || status.record.state == *state) && list.size() < limit) list.push_back(std::move(status));
    }
    if (page.size() < limit) break;
    last = page.back().id;
  }
  return list;
}

store::StoredResult JobQueue::result(const std::string& id) const {
  const auto record = status(id).record;
  if (record.state == JobState::dismissed) throw Error("job.dismissed", "The job " + id + " was dismissed.");
  if (!is_finished(record.state)) {
    throw problem::ProblemError(
        {"job.not_finished", "The job " + id + " is " + std::string(state_name(record.state)) + ".", {}, {}, 1});
  }
  return store_.job_result(id);
}

JobStatus JobQueue::wait_for_change(const std::string& id, std::uint64_t& version, double seconds) const {
  {
    std::unique_lock lock(mutex_);
    if (const auto job = find(id)) {
      changed_.wait_for(lock, duration(seconds), [&] { return job->finished || job->version != version; });
      if (!job->finished) {
        version = job->version;
        return status_of(*job);
      }
    }
  }
  // Not in this process: it has ended, or another server has it.
  const auto end = Clock::now() + duration(seconds);
  while (true) {
    auto now = status(id);
    const auto seen = is_finished(now.record.state) ? std::numeric_limits<std::uint64_t>::max()
                                                    : static_cast<std::uint64_t>(now.revision) + 1;
    if (seen != version || is_finished(now.record.state) || Clock::now() >= end || !store_.is_shared()) {
      version = seen;
      return now;
    }
    std::this_thread::sleep_for(look_at_other_servers);
  }
}

bool JobQueue::mesh_in_use(const std::string& mesh) const {
  {
    const std::lock_guard lock(mutex_);
    if (std::any_of(jobs_.begin(), jobs_.end(), [&](const auto& entry) { return entry.second->record.mesh == mesh; }))
      return true;
  }
  return store_.has_unfinished_job_on(mesh);
}

std::size_t JobQueue::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

std::size_t JobQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

}  // namespace supple::jobs
