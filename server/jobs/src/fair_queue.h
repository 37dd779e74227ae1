#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "job.h"

namespace supple::jobs {

/// The jobs that wait for a worker, in the order of their arrival, and the number of running jobs of each client: those
/// in the background, which have workers of their own, and the others. It belongs to the scheduler, whose mutex guards
/// it.
class FairQueue {
 public:
  explicit FairQueue(const QueueOptions& options) : options_(options) {}

  /// Throws "job.queue_full" if there is no place for the job, and "job.client_queue_full" if too many jobs of its
  /// client wait.
  void require_place(const Computation& computation) const;
  /// Adds a job at the end. A paused job counts for the limits, but next() does not return it.
  void add(const JobPointer& job, bool is_paused);
  void pause(const Job& job, bool is_paused);
  void remove(const Job& job);
  /// The job to run next of those whose priority is from `first` to `last`: of the most urgent ones, the first one of
  /// the client with the fewest running jobs. Null if no job may run now. Only one job at a time runs its last attempt
  /// (JobQueue), since such a job may make the process crash.
  JobPointer next(Priority first, Priority last) const;
  /// The jobs that are not paused and whose stop has been requested.
  std::vector<JobPointer> stopped_jobs() const;
  std::vector<JobPointer> jobs() const;
  std::size_t size() const { return entries_.size(); }
  /// Number of jobs of this priority.
  std::size_t size(Priority priority) const;

  void begin(const Job& job);
  /// Counts one running job of the client less, since its worker is free again.
  void end(const std::string& client, Priority priority);
  bool is_last_attempt(const Job& job) const;
  void set_last_attempt_runs(bool runs) { last_attempt_runs_ = runs; }
  /// Notes the seconds that a worker took for a job. Their average tells refused clients when to try again.
  void note_time(double seconds);

 private:
  struct Entry {
    JobPointer job;
    bool is_paused = false;
  };
  std::deque<Entry>::iterator find(const Job& job);
  /// A client and whether the jobs are in the background.
  using Runner = std::pair<std::string, bool>;
  static Runner runner_of(const std::string& client, Priority priority) {
    return {client, priority == Priority::background};
  }
  int running_jobs_of(const Runner& runner) const;

  const QueueOptions& options_;
  std::deque<Entry> entries_;
  std::int64_t bytes_ = 0;  // memory of the jobs in the queue
  std::map<Runner, int> running_;
  bool last_attempt_runs_ = false;
  double mean_seconds_ = 0;  // moving average of the time that a worker takes for a job
};

}  // namespace supple::jobs
