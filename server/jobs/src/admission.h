#pragma once

#include <functional>
#include <optional>
#include <string>

#include "job_reader.h"
#include "job_runner.h"

namespace supple::jobs {

/// How a computation becomes a job: it gets its place in the queue first, and then its row in the store, which is
/// written while no mutex is locked. Any thread may call.
class Admission {
 public:
  Admission(const store::JobStore& store, JobBoard& board, Scheduler& scheduler, Journal& journal,
            const JobRunner& runner, const JobReader& reader)
      : store_(store), board_(board), scheduler_(scheduler), journal_(journal), runner_(runner), reader_(reader) {}

  /// Does what JobQueue::submit says.
  JobStatus submit(Computation computation, const std::optional<RequestOfJob>& request);
  /// Does what JobQueue::run_within says.
  JobQueue::ResultOrJob run_within(Computation computation, double seconds, const std::function<bool()>& hung_up,
                                   const std::optional<RequestOfJob>& request);
  /// Computes on a worker, and waits for the result however long that takes. Nobody else learns of the job. Throws what
  /// `run_within` throws. Without hanging up, a client waits until the computation's deadline at most.
  Result run_in_background(Computation computation, const std::function<bool()>& hung_up, Profile* profile);

 private:
  /// The status of the job with this idempotency key. Throws "job.key_reused" if it had another request.
  std::optional<JobStatus> job_of_key(const std::string& key, const std::string& request_hash) const;
  /// Writes the row of a job, which nobody starts or ends meanwhile, and returns its status. If another request has
  /// used its idempotency key meanwhile, the status of that one's job is returned.
  JobStatus write_row(const JobPointer& job, const store::JobRecord& record,
                      const std::optional<RequestOfJob>& request);
  std::optional<store::JobRecord> begin_row(const JobPointer& job);
  /// Stops a job that gets no row, so that nobody can ask for it.
  void leave_without_row(const JobPointer& job);
  void add_to_journal(const JobPointer& job, const store::JobRecord& record,
                      const std::optional<RequestOfJob>& request);

  const store::JobStore& store_;
  JobBoard& board_;
  Scheduler& scheduler_;
  Journal& journal_;
  const JobRunner& runner_;
  const JobReader& reader_;
};

}  // namespace supple::jobs
