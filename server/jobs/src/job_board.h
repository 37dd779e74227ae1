#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "job.h"

namespace supple::jobs {

/// The unfinished jobs of this process and how far each is. It does no input or output and calls nobody, so that its
/// mutex is never locked for long: a computation that reports progress needs it. No other is locked while it is.
///
/// One thread gets the right to end a job (`claim_end`), stores its end without any mutex, and then completes or
/// releases it. While the row of a job is being written, nobody starts or ends the job, and its record does not change.
class JobBoard {
 public:
  explicit JobBoard(bool is_store_shared) : is_store_shared_(is_store_shared) {}

  void add(const JobPointer& job);
  bool has(const std::string& id) const;

  /// Begins to write the row of a job that has none, and returns its record. Waits for a thread that ends the job;
  /// nothing if the job is over.
  std::optional<store::JobRecord> begin_row(Job& job);
  void row_written(Job& job);
  /// The job has no row, so that nobody can ask for it: it is stopped as if its client had hung up. Returns whether it
  /// still waits for a worker; then it is released.
  bool row_failed(Job& job);

  struct Start {
    std::optional<store::JobRecord> record;  ///< what the store has to write; empty if the job has no row
  };
  /// A worker starts a job that waits. Nothing if another thread ends it.
  std::optional<Start> start(Job& job);
  void set_running(Job& job);
  /// The next start of the job goes on with what was saved, so that earlier starts do not count against it any more.
  /// The record if this changes it and the store has to write it.
  std::optional<store::JobRecord> count_starts_anew(Job& job);
  void set_progress(Job& job, double fraction, std::string_view stage);
  /// `notify`: whether clients hear of it now, and not with the next change.
  void set_partial(Job& job, std::string_view partial, bool notify);
  /// The client has hung up that waits for a job without a row.
  void set_client_left(Job& job);
  /// Since when the computation of a job should have stopped, if that is longer ago than Watchdog::patience.
  std::optional<Watchdog::Overdue> overdue(const Job& job, Clock::time_point now) const;

  struct Claim {
    store::JobRecord record;
    bool has_row = false;
  };
  /// Gives the caller the right to end a job. Waits while its row is being written. Nothing if another thread has the
  /// right, after it has ended the job.
  std::optional<Claim> claim_end(Job& job);
  /// Does the same without waiting. Nothing if the row of the job is being written, or if another thread has the right.
  std::optional<Claim> try_claim_end(Job& job);
  void complete(Job& job, store::JobRecord record, std::optional<Result> result, std::exception_ptr failure);
  void release(Job& job);
  bool has_ended(const Job& job) const;
  /// Waits until a job is over, or until `end`. Returns whether it is over.
  bool wait_until_over(const Job& job, Clock::time_point end) const;

  /// A job that has a row, or gets one now; null if there is none.
  JobPointer find(const std::string& id) const;
  JobStatus status_of(const Job& job) const;
  /// The status of a job that memory knows better than the store. In a shared store, that is a running one: other
  /// servers may have taken, and ended, a job that waits here.
  std::optional<JobStatus> status_in_memory(const std::string& id) const;
  /// Waits until the job's status has changed since `version`, or for `seconds`. Nothing if the job is over.
  std::optional<JobStatus> wait_for_change(const Job& job, std::uint64_t& version, double seconds) const;
  bool is_mesh_in_use(const std::string& mesh) const;

  struct LeasedJob {
    JobPointer job;
    std::int64_t fencing_token = 0;
    std::uint64_t version = 0;
    std::optional<store::JobProgress> progress;  ///< set if it is newer than `shared_version`
  };
  /// The jobs with a row, for the lease keeper.
  std::vector<LeasedJob> leased_jobs() const;

  void stop_all(StopReason reason);

 private:
  // The caller of the following functions holds the mutex.
  static std::optional<Claim> begin_end(Job& job);
  void forget(Job& job, Phase phase);
  JobPointer find_job(const std::string& id) const;
  static JobStatus status(const Job& job) { return {job.record, job.progress, job.stage, job.partial}; }
  static bool is_over(const Job& job) { return job.phase == Phase::ended || job.phase == Phase::released; }

  const bool is_store_shared_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<std::string, JobPointer> jobs_;
};

}  // namespace supple::jobs
