#include <utility>

#include "family_rows.h"
#include "file_access.h"
#include "record_file.h"
#include "shared_schema.h"
#include "shared_state.h"
#include "sql_names.h"

namespace supple::store {
namespace {

/// A row for each job, and a file for each result.
class SharedJobs final : public JobStore {
 public:
  explicit SharedJobs(SharedState& state) : state_(state) {}

  bool add_job(const JobRecord& job, const std::string& request) override {
    const auto bytes =
        request.empty() ? bytes_of(state_.paths.request(job.id)) : static_cast<std::int64_t>(request.size());
    const bool added = state_.database.transaction([&](pqxx::work& transaction) {
      for (const auto& id : family_ids(job))
        if (transaction.exec_params("SELECT 1 FROM families WHERE id = $1 FOR KEY SHARE", id).empty())
          throw_family_removed();
      // If this transaction is run again, it adds nothing to what its first run has added.
      return insert_shared_job(transaction, job, bytes, state_.server, request);
    });
    if (added && request.empty())
      state_.add(Category::requests, bytes);  // small requests count as part of the database
    return added;
  }

  bool update_job(const JobRecord& job) override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      transaction.exec0("SET LOCAL synchronous_commit TO OFF");
      return transaction
                 .exec_params(
                     "UPDATE jobs SET state = $2, started = $3, attempts = $4, revision = revision + 1, "
                     "holder = CASE WHEN $2 = 'accepted' THEN '' ELSE holder END "
                     "WHERE id = $1 AND finished = 0 AND holder = $5 AND hold = $6",
                     job.id, std::string(state_name(job.state)), job.started, job.attempts, state_.server,
                     job.fencing_token)
                 .affected_rows() > 0;
    });
  }

  bool finish_job(const JobRecord& job, const Result* result) override {
    const auto path = state_.paths.result(shared_result_stem(job.id, job.fencing_token));
    if (!has_lease(job)) return false;  // the job may have ended with this file, which then stays
    state_.remove_results_before(job.id, job.fencing_token);
    ResultFile file;
    bool updated = false;
    try {
      if (result) {
        file.hash = sha256(result->body);
        const auto header = result_file(job, *result).header(file.hash);
        file.bytes = static_cast<std::int64_t>(header.size() + result->body.size());
        state_.make_room(Category::results, file.bytes, job.owner, job.id);
        write_stored_file(path, {header, result->body});
      }
      updated = state_.database.transaction([&](pqxx::work& transaction) {
        const auto rows = transaction.exec_params(
            "UPDATE jobs SET state = $2, started = $3, finished = $4, expires = $5, error = $6, error_status = $7, "
            "attempts = $8, bytes = $9, result_type = $10, result_headers = $11, result_hash = $12, request = NULL, "
            "partial = '', revision = revision + 1 WHERE id = $1 AND finished = 0 AND holder = $13 AND hold = $14",
            job.id, std::string(state_name(job.state)), job.started, job.finished, job.expires, job.error,
            job.error_status, job.attempts, file.bytes, result ? result->content_type : std::string(),
            result ? join_headers(*result) : std::string(), file.hash, state_.server, job.fencing_token);
        return rows.affected_rows() > 0;
      });
    } catch (...) {
      // If the database was lost during the commit, it is unknown whether it has committed; then the file stays.
      if (result && !may_be_committed(job, file.hash)) SharedState::remove_file(path);
      throw;
    }
    if (updated) {
      SharedState::remove_file(state_.paths.request(job.id));
      state_.add(Category::results, file.bytes);
    } else {
      SharedState::remove_file(path);
    }
    return updated;
  }

  std::optional<JobRecord> job(const std::string& id) const override { return state_.find_job("id = $1", id); }

  std::vector<JobRecord> jobs(const std::vector<JobState>& states, std::size_t limit, const std::string& after,
                              const std::string& owner) const override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      std::vector<JobRecord> records;
      const auto rows = transaction.exec_params(
          "SELECT " + shared_job_columns() +
              " FROM jobs WHERE ($1 = '' OR sequence < (SELECT sequence FROM jobs WHERE id = $1))" +
              (states.empty() ? "" : " AND state IN (" + sql_names(states) + ")") +
              " AND ($3 = '' OR owner = $3) ORDER BY sequence DESC LIMIT $2",
          after, static_cast<std::int64_t>(limit), owner);
      for (const auto& row : rows) records.push_back(read_shared_job(row));
      return records;
    });
  }

  std::optional<JobRecord> job_of_key(const std::string& key) const override {
    return state_.find_job("idempotency_key = $1", key);
  }

  bool owns_job(const std::string& id, const std::string& owner) const override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      return !transaction.exec_params("SELECT 1 FROM jobs WHERE id = $1 AND owner = $2", id, owner).empty();
    });
  }

  bool remove_job(const std::string& id) override {
    return state_.remove_jobs("SELECT sequence FROM jobs WHERE id = $1 AND finished > 0", id) > 0;
  }

  std::vector<JobRecord> unfinished_jobs() const override { return {}; }

  std::size_t remove_expired_jobs(std::int64_t now, std::size_t max_count) override {
    state_.quarantine_orphans();
    return state_.remove_jobs(
        "SELECT sequence FROM jobs WHERE finished > 0 AND (expires <= $1 OR sequence NOT IN "
        "(SELECT sequence FROM jobs WHERE finished > 0 ORDER BY sequence DESC LIMIT $2)) FOR UPDATE SKIP LOCKED",
        now, static_cast<std::int64_t>(max_count));
  }

 private:
  /// Whether this server has the lease of the job, and the job is unfinished.
  bool has_lease(const JobRecord& job) {
    return state_.database.transaction([&](pqxx::work& transaction) {
      return !transaction
                  .exec_params("SELECT 1 FROM jobs WHERE id = $1 AND finished = 0 AND holder = $2 AND hold = $3",
                               job.id, state_.server, job.fencing_token)
                  .empty();
    });
  }

  /// Whether the database has this result of the job, or cannot be asked.
  bool may_be_committed(const JobRecord& job, const std::string& hash) {
    try {
      return state_.database.transaction([&](pqxx::work& transaction) {
        return !transaction
                    .exec_params("SELECT 1 FROM jobs WHERE id = $1 AND hold = $2 AND result_hash = $3", job.id,
                                 job.fencing_token, hash)
                    .empty();
      });
    } catch (const Error&) {
      return true;
    }
  }

  SharedState& state_;
};

}  // namespace

std::unique_ptr<JobStore> make_shared_jobs(SharedState& state) { return std::make_unique<SharedJobs>(state); }

}  // namespace supple::store
