#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "job_board.h"
#include "journal.h"

namespace supple::jobs {

/// What clients see of jobs: the board knows those of this process, the journal the ends that the store refused, and
/// the store all others. Any thread may call. Functions do what those of JobQueue say.
class JobReader {
 public:
  JobReader(const store::Store& store, const JobBoard& board, const Journal& journal)
      : store_(store), board_(board), journal_(journal) {}

  JobStatus status(const std::string& id) const;
  std::vector<JobStatus> list(std::optional<JobState> state, std::size_t limit, const std::string& after,
                              const std::string& owner) const;
  store::StoredResult result(const std::string& id) const;
  JobStatus wait_for_change(const std::string& id, std::uint64_t& version, double seconds) const;
  bool is_mesh_in_use(const std::string& mesh) const;

 private:
  /// The status of a job that memory knows better than the store.
  std::optional<JobStatus> status_in_memory(const std::string& id) const;
  JobStatus status_in_store(const store::JobRecord& record) const;

  const store::Store& store_;
  const JobBoard& board_;
  const Journal& journal_;
};

}  // namespace supple::jobs
