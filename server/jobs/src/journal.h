#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "job.h"

namespace supple::jobs {

/// The error of a job whose idempotency key another job has.
class KeyIsUsed : public Error {
 public:
  KeyIsUsed() : Error("job.key_reused", "The Idempotency-Key of this request is used by another one.") {}
};

/// Writes jobs to the store, and holds in memory the ends that the store did not take. Its mutex guards those ends
/// alone, and is not locked while the store is called.
class Journal {
 public:
  Journal(store::Store& store, const QueueOptions& options, JobQueue::Render render, JobQueue::Log log);

  /// Writes the request and then the row of a job. If it throws, nothing stays. Throws KeyIsUsed, "store.full",
  /// "store.quota", "store.unavailable".
  void add(const store::JobRecord& record, const std::optional<RequestOfJob>& request);
  /// Tells the store that a job starts, or waits again. False if another server has the job. If the store does not take
  /// it, and the process crashes, this start does not count.
  bool update(const store::JobRecord& record);

  /// Fills the record of a job that ends now, and has failed if there is a problem.
  void set_end(store::JobRecord& record, JobState state, const std::optional<problem::Problem>& problem) const;
  /// Stores how a job ended. If the store refuses the result, the job has failed with the reason; if it refuses the end
  /// altogether, the end is held in memory. False if another server has the job, or will have it when the lease of this
  /// server has ended.
  bool end(store::JobRecord& record, const Result* result);
  /// Writes the ends that the store refused before.
  void write_refused_ends();
  /// The end of a job that the store did not take.
  std::optional<store::JobRecord> refused_end(const std::string& id) const;
  bool has_refused_ends() const;
  void forget_refused_end(const std::string& id);

  /// When a job expires that ends at this time, in milliseconds since 1970.
  std::int64_t expiry(std::int64_t finished) const;

 private:
  void set_error(store::JobRecord& record, const problem::Problem& problem) const;
  enum class Written { stored, refused, of_another_server };
  Written write_end(store::JobRecord& record, const Result* result);
  Written refused_by_store(store::JobRecord& record, const Result* result) const;

  store::Store& store_;
  const QueueOptions& options_;
  const JobQueue::Render render_;
  const JobQueue::Log log_;
  mutable std::mutex mutex_;
  std::map<std::string, store::JobRecord> refused_ends_;
};

}  // namespace supple::jobs
