// What servers of a shared store tell each other, and how they take each other's jobs.

#include <map>
#include <utility>
#include <vector>

#include "job.h"

namespace supple::jobs {
namespace {

constexpr std::chrono::milliseconds between_looks{500};
constexpr std::chrono::milliseconds while_there_are_more{50};

}  // namespace

void JobQueue::share() {
  std::unique_lock lock(mutex_);
  bool answers = true;
  while (!ending_) {
    lock.unlock();
    bool more = false;
    try {
      more = share_once();
      if (!answers && log_) log_("the database that servers share answers again");
      answers = true;
    } catch (const Error& error) {
      // What this server holds may be others' before it answers again, which the next look tells.
      if (answers && log_) log_(std::string("the database that servers share does not answer: ") + error.what());
      answers = false;
    }
    lock.lock();
    end_.wait_for(lock, more ? while_there_are_more : between_looks, [this] { return ending_; });
  }
}

bool JobQueue::share_once() {
  std::vector<store::JobProgress> progress;
  std::vector<std::pair<JobPointer, std::int64_t>> here;  // with their holds, before the database is asked
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, job] : jobs_) {
      if (!job->visible) continue;
      here.emplace_back(job, job->record.hold);
      if (job->record.state != JobState::running || job->version == job->shared_version) continue;
      job->shared_version = job->version;
      progress.push_back({id, job->progress, job->stage, job->partial});
    }
  }
  std::map<std::string, std::int64_t> held;
  for (auto& [id, hold] : store_.keep_holds(progress)) held.emplace(std::move(id), hold);
  for (const auto& [job, hold] : here) {
    const auto found = held.find(job->record.id);
    if (found != held.end() && found->second == hold) {
      held.erase(found);
      continue;
    }
    lose(job);
  }
  for (const auto& [id, hold] : held) take_over_if_unknown(id, hold);

  std::size_t idle = 0;
  {
    const std::lock_guard lock(mutex_);
    if (refusing_) return false;
    const auto busy = running_ + queue_.size();
    const auto workers = static_cast<std::size_t>(options_.workers);
    idle = busy < workers ? workers - busy : 0;
  }
  auto taken = store_.take_jobs(idle);
  for (auto& record : taken) {
    const std::lock_guard lock(mutex_);
    if (refusing_) break;  // the store frees them at its end
    take_over(std::move(record));
  }
  return !taken.empty();
}

void JobQueue::take_over_if_unknown(const std::string& id, std::int64_t hold) {
  const auto is_known = [&] { return refusing_ || jobs_.contains(id) || unwritten_.contains(id); };
  {
    const std::lock_guard lock(mutex_);
    if (is_known()) return;
  }
  // The answer to the call that took it was lost; or it has ended meanwhile.
  auto record = store_.job(id);
  if (!record || is_finished(record->state) || record->hold != hold) return;
  const std::lock_guard lock(mutex_);
  if (!is_known()) take_over(*std::move(record));
}

}  // namespace supple::jobs
