#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "client_turns.h"
#include "job.h"

namespace supple::jobs {

/// The jobs that wait for a worker, in the order of their arrival, and whose turn it is. Those in the background have
/// workers of their own. It belongs to the scheduler, whose mutex guards it.
class FairQueue {
 public:
  explicit FairQueue(const QueueOptions& options) : options_(options), turns_(options.workers) {}

  /// Throws "job.queue_full" if there is no place for the job, and "job.client_queue_full" if too many jobs of its
  /// client wait. Jobs in the background have places of their own, as many as the others, so that they take none of
  /// these.
  void require_place(const Computation& computation) const;
  /// Adds a job at the end. A paused job counts for the limits, but next() does not return it.
  void add(const JobPointer& job, bool is_paused);
  void pause(const Job& job, bool is_paused);
  void remove(const Job& job);
  /// The job to run next of those whose priority is from `first` to `last`: of the most urgent ones, the first one of
  /// the client with the fewest running jobs. An interactive job counts as a normal one where ClientTurns says so,
  /// and comes first among the normal ones then, if its client has no more running jobs than others. Null if no job may
  /// run now. Only one job at a time runs its last attempt (JobQueue), since such a job may make the process crash.
  JobPointer next(Priority first, Priority last) const;
  /// The jobs that are not paused and whose stop has been requested.
  std::vector<JobPointer> stopped_jobs() const;
  std::vector<JobPointer> jobs() const;
  std::size_t size() const { return entries_.size(); }
  /// Number of jobs of this priority.
  std::size_t size(Priority priority) const;

  void begin(const Job& job);
  /// Counts one running job of the client less, since its worker is free again.
  void end(const std::string& client, Priority priority) { turns_.end(client, priority); }
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
  static bool is_in_background(const Job& job) { return job.computation.priority == Priority::background; }
  /// The next job of those whose urgency is from `first` to `last`.
  JobPointer first_of(Priority first, Priority last) const;

  const QueueOptions& options_;
  std::deque<Entry> entries_;
  ClientTurns turns_;
  bool last_attempt_runs_ = false;
  double mean_seconds_ = 0;  // moving average of the time that a worker takes for a job
};

}  // namespace supple::jobs
