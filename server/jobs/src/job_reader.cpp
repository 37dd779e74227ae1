#include "job_reader.h"

#include <chrono>
#include <limits>
#include <thread>
#include <utility>

namespace supple::jobs {

std::optional<JobStatus> JobReader::status_in_memory(const std::string& id) const {
  if (auto status = board_.status_in_memory(id)) return status;
  if (auto end = journal_.refused_end(id)) return JobStatus{*std::move(end), 0, {}};
  return std::nullopt;
}

JobStatus JobReader::status_in_store(const store::JobRecord& record) const {
  JobStatus status{record, record.state == JobState::successful ? 1.0 : 0.0, {}};
  auto* const leases = store_.leases();
  if (record.state != JobState::running || !leases) return status;
  if (auto progress = leases->job_progress(record.id)) {
    status.progress = progress->fraction;
    status.stage = std::move(progress->stage);
    status.partial = std::move(progress->partial);
    status.revision = progress->revision;
  }
  return status;
}

JobStatus JobReader::status(const std::string& id) const {
  if (auto status = status_in_memory(id)) return *std::move(status);
  const auto record = store_.jobs().job(id);
  if (!record) throw_not_found(id);
  return status_in_store(*record);
}

std::vector<JobStatus> JobReader::list(std::optional<JobState> state, std::size_t limit, const std::string& after,
                                       const std::string& owner) const {
  // A running job may be accepted in the store, so unfinished jobs are listed together, and memory tells their states.
  // Jobs whose end the store refused are unfinished there: while there are any, jobs of all states are listed.
  std::vector<JobState> in_store;
  if (state) in_store = is_finished(*state) ? std::vector{*state} : std::vector{JobState::accepted, JobState::running};
  if (journal_.has_refused_ends()) in_store.clear();
  std::vector<JobStatus> list;
  std::string last = after;
  while (list.size() < limit) {
    const auto page = store_.jobs().jobs(in_store, limit, last, owner);
    for (const auto& record : page) {
      auto status = status_in_store(record);
      if (auto newer = status_in_memory(record.id)) status = *std::move(newer);
      if ((!state || status.record.state == *state) && list.size() < limit) list.push_back(std::move(status));
    }
    if (page.size() < limit) break;
    last = page.back().id;
  }
  return list;
}

store::StoredResult JobReader::result(const std::string& id) const {
  const auto record = status(id).record;
  if (record.state == JobState::dismissed) throw Error("job.dismissed", "The job " + id + " was dismissed.");
  if (!is_finished(record.state)) {
    throw problem::ProblemError(
        {"job.not_finished", "The job " + id + " is " + std::string(state_name(record.state)) + ".", {}, {}, 1});
  }
  return store_.blobs().job_result(id);
}

JobStatus JobReader::wait_for_change(const std::string& id, std::uint64_t& version, double seconds) const {
  constexpr std::chrono::milliseconds check_interval{200};  // time between two questions to the store
  if (const auto job = board_.find(id))
    if (auto status = board_.wait_for_change(*job, version, seconds)) return *std::move(status);
  // The job is over here, or another server has it.
  const auto end = Clock::now() + duration(seconds);
  while (true) {
    auto now = status(id);
    const auto seen = is_finished(now.record.state) ? std::numeric_limits<std::uint64_t>::max()
                                                    : static_cast<std::uint64_t>(now.revision) + 1;
    if (seen != version || is_finished(now.record.state) || Clock::now() >= end || !store_.leases()) {
      version = seen;
      return now;
    }
    std::this_thread::sleep_for(check_interval);
  }
}

bool JobReader::is_mesh_in_use(const std::string& mesh) const {
  if (board_.is_mesh_in_use(mesh)) return true;
  const auto* const leases = store_.leases();
  return leases && leases->has_unfinished_job_on(mesh);
}

}  // namespace supple::jobs
