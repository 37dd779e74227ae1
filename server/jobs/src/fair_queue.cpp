#include "fair_queue.h"

#include <algorithm>
#include <cmath>

namespace supple::jobs {
namespace {

problem::ProblemError queue_full(const std::string& detail, double limit, double value, const std::string& setting,
                                 int retry_after) {
  return problem::ProblemError({"job.queue_full",
                                detail + " (setting " + setting + ").",
                                {},
                                problem::Limit{limit, value, setting},
                                retry_after});
}

}  // namespace

void FairQueue::require_place(const Computation& computation) const {
  // There is a place once one of the workers has taken the next job.
  constexpr double max_seconds = 3600;
  const double seconds = std::clamp(mean_seconds_ / options_.workers, 1.0, max_seconds);
  const int retry_after = static_cast<int>(std::ceil(seconds));
  const bool in_background = computation.priority == Priority::background;
  std::size_t waiting = 0;
  std::int64_t bytes = computation.bytes;
  int of_client = 0;
  for (const auto& entry : entries_) {
    if (is_in_background(*entry.job) != in_background) continue;
    ++waiting;
    bytes += entry.job->computation.bytes;
    if (entry.job->computation.client == computation.client) ++of_client;
  }
  const std::string jobs = in_background ? " jobs in the background" : " jobs";
  if (const auto limit = computation.max_waiting; limit > 0 && of_client >= limit) {
    throw problem::ProblemError({"job.client_queue_full",
                                 std::to_string(limit) + jobs +
                                     " of this key wait for a worker, its limit (setting --max-waiting-jobs of its "
                                     "key).",
                                 {},
                                 problem::Limit{1.0 * limit, 1.0 * limit + 1, "--max-waiting-jobs"},
                                 retry_after});
  }
  if (waiting >= options_.max_queue) {
    const auto limit = static_cast<double>(options_.max_queue);
    throw queue_full("The queue holds " + std::to_string(options_.max_queue) + jobs + ", its limit", limit, limit + 1,
                     "--max-queue", retry_after);
  }
  if (bytes > options_.max_queue_bytes) {
    throw queue_full("With this job the" + jobs + " that wait would hold " + std::to_string(bytes) +
                         " bytes of memory, their limit is " + std::to_string(options_.max_queue_bytes),
                     static_cast<double>(options_.max_queue_bytes), static_cast<double>(bytes), "--max-queue-bytes",
                     retry_after);
  }
}

std::deque<FairQueue::Entry>::iterator FairQueue::find(const Job& job) {
  return std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.job.get() == &job; });
}

void FairQueue::add(const JobPointer& job, bool is_paused) { entries_.push_back({job, is_paused}); }

void FairQueue::pause(const Job& job, bool is_paused) {
  if (const auto entry = find(job); entry != entries_.end()) entry->is_paused = is_paused;
}

void FairQueue::remove(const Job& job) {
  if (const auto entry = find(job); entry != entries_.end()) entries_.erase(entry);
}

bool FairQueue::is_last_attempt(const Job& job) const {
  return job.earlier_attempts > 0 && job.earlier_attempts + 1 >= options_.max_attempts;
}

JobPointer FairQueue::first_of(Priority first, Priority last) const {
  const Entry* next = nullptr;
  ClientTurns::Rank least;
  for (const auto& entry : entries_) {
    if (entry.is_paused || (last_attempt_runs_ && is_last_attempt(*entry.job))) continue;
    const auto& computation = entry.job->computation;
    const auto rank = turns_.rank_of(computation.client, computation.priority);
    if (rank.urgency < first || rank.urgency > last || (next && rank >= least)) continue;
    next = &entry;
    least = rank;
  }
  return next ? next->job : nullptr;
}

JobPointer FairQueue::next(Priority first, Priority last) const {
  if (first == Priority::interactive && last >= Priority::normal && turns_.is_turn_of_others())
    if (auto job = first_of(Priority::normal, Priority::normal)) return job;
  return first_of(first, last);
}

std::size_t FairQueue::size(Priority priority) const {
  return static_cast<std::size_t>(std::count_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.job->computation.priority == priority;
  }));
}

std::vector<JobPointer> FairQueue::stopped_jobs() const {
  std::vector<JobPointer> stopped;
  for (const auto& entry : entries_)
    if (!entry.is_paused && entry.job->token.requested()) stopped.push_back(entry.job);
  return stopped;
}

std::vector<JobPointer> FairQueue::jobs() const {
  std::vector<JobPointer> jobs;
  for (const auto& entry : entries_) jobs.push_back(entry.job);
  return jobs;
}

void FairQueue::begin(const Job& job) {
  const bool others_wait = std::any_of(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return !entry.is_paused && entry.job->computation.priority == Priority::normal;
  });
  turns_.begin(job.computation.client, job.computation.priority, others_wait);
}

void FairQueue::note_time(double seconds) {
  constexpr double weight_of_latest = 0.1;
  mean_seconds_ += weight_of_latest * (seconds - mean_seconds_);
}

}  // namespace supple::jobs
