#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "job_runner.h"

namespace supple::jobs {

/// Keeps the leases of this server's jobs in a shared store: tells the other servers about their progress, stops jobs
/// that others have taken or dismissed, and takes jobs that others cannot run. For one thread.
class LeaseKeeper {
 public:
  LeaseKeeper(store::LeaseStore& leases, const store::JobStore& jobs, JobBoard& board, const Scheduler& scheduler,
              const Journal& journal, JobRunner& runner, JobQueue::Log log);

  /// Renews the leases once. Returns the time to the next call.
  std::chrono::milliseconds renew();

 private:
  /// Returns whether it took jobs of others.
  bool exchange();
  /// Takes over a job that the store says this server has.
  void take_over_unless_known(const std::string& id, std::int64_t fencing_token);

  store::LeaseStore& leases_;
  const store::JobStore& jobs_;
  JobBoard& board_;
  const Scheduler& scheduler_;
  const Journal& journal_;
  JobRunner& runner_;
  const JobQueue::Log log_;
  bool answers_ = true;  // whether the database has answered the last call
};

}  // namespace supple::jobs
