#include <algorithm>

#include "shared_schema.h"
#include "shared_state.h"

namespace supple::store {
namespace {

/// Number of lost servers' jobs of each kind, in the background or not, that one call may take, even if it asks for
/// fewer. It is small, so that other servers get some too.
constexpr std::size_t abandoned_jobs_per_call = 8;

constexpr const char* by_urgency = "array_position(ARRAY['interactive', 'normal', 'background'], priority), sequence";

/// The leases of jobs, by the clock of the database.
class SharedLeases final : public LeaseStore {
 public:
  explicit SharedLeases(SharedState& state) : state_(state) {}

  std::vector<LeasedJob> renew_leases(const std::vector<JobProgress>& running) override {
    state_.renew_server_lease();
    auto leased = state_.transaction_with_mesh_uses([&](pqxx::work& transaction) {
      transaction.exec0("SET LOCAL synchronous_commit TO OFF");
      for (const auto& job : running) {
        transaction.exec_params(
            "UPDATE jobs SET progress = $2, stage = $3, partial = $4, revision = revision + 1 "
            "WHERE id = $1 AND finished = 0 AND holder = $5",
            job.id, job.fraction, job.stage, job.partial, state_.server);
      }
      std::vector<LeasedJob> jobs;
      for (const auto& row :
           transaction.exec_params("SELECT id, hold FROM jobs WHERE holder = $1 AND finished = 0", state_.server))
        jobs.push_back({row[0].c_str(), row[1].as<std::int64_t>()});
      return jobs;
    });
    if (state_.is_recount_due()) state_.count();
    return leased;
  }

  std::vector<JobRecord> lease_jobs(const IdleWorkers& idle) override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      std::vector<JobRecord> taken;
      const auto take = [&](const std::string& condition, std::size_t limit) {
        const auto rows = transaction.exec_params(
            "WITH free AS (SELECT id, sequence FROM jobs "
            "WHERE finished = 0 AND holder <> $1 AND " +
                condition + " ORDER BY " + by_urgency +
                " LIMIT $2 FOR UPDATE SKIP LOCKED), "
                "taken AS (UPDATE jobs SET holder = $1, hold = hold + 1, revision = revision + 1 FROM free "
                "WHERE jobs.id = free.id RETURNING jobs.*) SELECT " +
                shared_job_columns() + " FROM taken AS jobs ORDER BY " + by_urgency,
            state_.server, static_cast<std::int64_t>(limit));
        for (const auto& row : rows) taken.push_back(read_shared_job(row));
      };
      const auto take_kind = [&](const std::string& kind, std::size_t idle_workers) {
        const auto before = taken.size();
        // A join would not do. If another server has just taken a row, PostgreSQL evaluates the condition again, but a
        // join would still use the old row of "servers".
        take("coalesce((SELECT until FROM servers WHERE servers.id = holder), '-infinity') < now() AND " + kind,
             std::max(idle_workers, abandoned_jobs_per_call));
        const auto lost = taken.size() - before;
        if (idle_workers > lost) take("state = 'accepted' AND " + kind, idle_workers - lost);
      };
      take_kind("priority <> 'background'", idle.foreground);
      take_kind("priority = 'background'", idle.background);
      return taken;
    });
  }

  std::optional<JobProgress> job_progress(const std::string& id) const override {
    return state_.database.transaction([&](pqxx::work& transaction) -> std::optional<JobProgress> {
      const auto rows =
          transaction.exec_params("SELECT progress, stage, partial, revision FROM jobs WHERE id = $1", id);
      if (rows.empty()) return std::nullopt;
      return JobProgress{id, rows[0][0].as<double>(), rows[0][1].c_str(), rows[0][2].c_str(),
                         rows[0][3].as<std::int64_t>()};
    });
  }

  std::optional<JobRecord> dismiss_job(const std::string& id, std::int64_t finished, std::int64_t expires) override {
    const bool dismissed = state_.database.transaction([&](pqxx::work& transaction) {
      return transaction
                 .exec_params(
                     "UPDATE jobs SET state = 'dismissed', finished = $2, expires = $3, request = NULL, bytes = 0, "
                     "hold = hold + 1, holder = '', partial = '', revision = revision + 1 WHERE id = $1 AND finished = "
                     "0",
                     id, finished, expires)
                 .affected_rows() > 0;
    });
    if (!dismissed) return std::nullopt;
    SharedState::remove_file(state_.paths.request(id));
    return state_.find_job("id = $1", id);
  }

  bool has_unfinished_job_on(const std::string& mesh) const override {
    return state_.database.transaction([&](pqxx::work& transaction) {
      return !transaction.exec_params("SELECT 1 FROM jobs WHERE mesh = $1 AND finished = 0 LIMIT 1", mesh).empty();
    });
  }

 private:
  SharedState& state_;
};

}  // namespace

std::unique_ptr<LeaseStore> make_shared_leases(SharedState& state) { return std::make_unique<SharedLeases>(state); }

}  // namespace supple::store
