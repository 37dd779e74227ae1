#include <utility>

#include "local_state.h"
#include "record_file.h"
#include "sql_names.h"

namespace supple::store {
namespace {

/// A row for each job, and a file for each result.
class LocalJobs final : public JobStore {
 public:
  explicit LocalJobs(LocalState& state) : state_(state) {}

  bool add_job(const JobRecord& job, const std::string& request) override {
    auto& database = state_.database;
    const auto limit = state_.limit_of(job.owner);
    const auto bytes =
        request.empty() ? bytes_of(state_.paths.request(job.id)) : static_cast<std::int64_t>(request.size());
    const std::lock_guard lock(state_.mutex);
    if (!job.idempotency_key.empty() && state_.find_job_of_key(job.idempotency_key)) return false;
    state_.make_room_within_owner_limit(job.owner, limit, Category::requests, bytes, job.id);
    Transaction transaction(database);
    for (const auto& id : family_ids(job)) {
      Statement family(database, "SELECT 1 FROM families WHERE id = ?");
      if (!family.bind(id).step()) throw_family_removed();
    }
    insert_job(database, job, bytes, state_.owners);
    if (!request.empty())
      Statement(database, "INSERT INTO requests (job, content) VALUES (?, ?)").bind(job.id).bind_bytes(request).run();
    transaction.commit();
    return true;
  }

  bool update_job(const JobRecord& job) override {
    const std::lock_guard lock(state_.mutex);
    auto& database = state_.database;
    const UnsyncedCommits unsynced(database);
    Statement(database, "UPDATE jobs SET state = ?, started = ?, attempts = ? WHERE id = ? AND finished = 0")
        .bind(state_name(job.state))
        .bind(job.started)
        .bind(static_cast<std::int64_t>(job.attempts))
        .bind(job.id)
        .run();
    return true;
  }

  bool finish_job(const JobRecord& job, const Result* result) override {
    const auto path = state_.paths.result(job.id);
    const auto limit = result ? state_.limit_of(job.owner) : 0;
    bool updated = false;
    try {
      ResultFile file;
      const auto make_room = [&] {
        state_.make_room_within_owner_limit(job.owner, limit, Category::results, file.bytes, job.id);
      };
      if (result) {
        file.hash = sha256(result->body);
        const auto header = result_file(job, *result).header(file.hash);
        file.bytes = static_cast<std::int64_t>(header.size() + result->body.size());
        if (limit > 0) {
          const std::lock_guard lock(state_.mutex);
          make_room();
        }
        state_.write_counted_file(Category::results, path, {header, result->body});
      }
      const std::lock_guard lock(state_.mutex);
      make_room();  // other jobs of the owner may have ended meanwhile
      updated = update_ended_job(state_.database, job, result, file);
    } catch (...) {
      // A result without a row would occupy space that is needed to store why the job failed.
      if (result) state_.delete_file(Category::results, path);
      throw;
    }
    if (!updated) state_.delete_file(Category::results, path);
    state_.delete_file(Category::requests, state_.paths.request(job.id));
    return updated;
  }

  std::optional<JobRecord> job(const std::string& id) const override {
    const std::lock_guard lock(state_.mutex);
    Statement row(state_.database, "SELECT " + job_columns_to_read() + " FROM jobs WHERE id = ?");
    if (!row.bind(id).step()) return std::nullopt;
    return read_job(row);
  }

  std::vector<JobRecord> jobs(const std::vector<JobState>& states, std::size_t limit, const std::string& after,
                              const std::string& owner) const override {
    const std::lock_guard lock(state_.mutex);
    Statement rows(state_.database,
                   "SELECT " + job_columns_to_read() +
                       " FROM jobs WHERE (?1 = '' OR sequence < (SELECT sequence FROM jobs WHERE id = ?1))" +
                       (states.empty() ? "" : " AND state IN (" + sql_names(states) + ")") + " AND " +
                       OwnerTable::condition(OwnerTable::Kind::job, "?3") + " ORDER BY sequence DESC LIMIT ?2");
    rows.bind(after).bind(static_cast<std::int64_t>(limit)).bind(owner);
    std::vector<JobRecord> records;
    while (rows.step()) records.push_back(read_job(rows));
    return records;
  }

  std::optional<JobRecord> job_of_key(const std::string& key) const override {
    const std::lock_guard lock(state_.mutex);
    return state_.find_job_of_key(key);
  }

  bool owns_job(const std::string& id, const std::string& owner) const override {
    const std::lock_guard lock(state_.mutex);
    return state_.owners.has(OwnerTable::Kind::job, id, owner);
  }

  bool remove_job(const std::string& id) override {
    const std::lock_guard lock(state_.mutex);
    if (!state_.with_reserve([&] { return state_.delete_row(id); })) return false;
    state_.delete_files(id);
    state_.reserve.refill();
    return true;
  }

  std::vector<JobRecord> unfinished_jobs() const override {
    const std::lock_guard lock(state_.mutex);
    Statement rows(state_.database, "SELECT " + job_columns_to_read() +
                                        " FROM jobs WHERE state IN ('accepted', 'running') ORDER BY sequence");
    std::vector<JobRecord> records;
    while (rows.step()) records.push_back(read_job(rows));
    return records;
  }

  std::size_t remove_expired_jobs(std::int64_t now, std::size_t max_count) override {
    state_.usage_counter.count_quarantine();
    const std::lock_guard lock(state_.mutex);
    std::vector<std::string> ids;
    {
      Statement rows(state_.database,
                     "SELECT id FROM jobs WHERE finished > 0 AND (expires <= ?1 OR sequence NOT IN "
                     "(SELECT sequence FROM jobs WHERE finished > 0 ORDER BY sequence DESC LIMIT ?2))");
      rows.bind(now).bind(static_cast<std::int64_t>(max_count));
      while (rows.step()) ids.push_back(rows.text(0));
    }
    state_.remove_jobs(ids);
    state_.reserve.refill();
    return ids.size();
  }

 private:
  LocalState& state_;
};

}  // namespace

std::unique_ptr<JobStore> make_local_jobs(LocalState& state) { return std::make_unique<LocalJobs>(state); }

}  // namespace supple::store
