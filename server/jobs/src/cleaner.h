#pragma once

#include <chrono>

#include "job_runner.h"

namespace supple::jobs {

/// What has to be done from time to time. For one thread.
class Cleaner {
 public:
  Cleaner(store::Store& store, const QueueOptions& options, Scheduler& scheduler, JobRunner& runner, Journal& journal)
      : store_(store), options_(options), scheduler_(scheduler), runner_(runner), journal_(journal) {}

  /// Ends jobs that were stopped while they waited, abandons jobs whose computations do not stop, and returns free
  /// memory; every second writes ends that the store has refused, and every minute removes what has expired. Returns
  /// the time to the next call.
  std::chrono::milliseconds clean_up();

 private:
  void remove_expired();

  store::Store& store_;
  const QueueOptions& options_;
  Scheduler& scheduler_;
  JobRunner& runner_;
  Journal& journal_;
  Clock::time_point next_write_ = Clock::now();
  Clock::time_point next_removal_ = Clock::now();
};

}  // namespace supple::jobs
