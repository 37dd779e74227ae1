#include <algorithm>
#include <utility>

#include "checked_content.h"
#include "file_access.h"
#include "record_file.h"
#include "shared_implementation.h"
#include "shared_schema.h"
#include "supple/base/error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Number of lost servers' jobs that one call may take, even if it asks for fewer. It is small, so that other servers
/// get some too.
constexpr std::size_t abandoned_jobs_per_call = 8;

std::int64_t integer_of(const pqxx::field& field) { return field.as<std::int64_t>(); }

}  // namespace

template <class... Values>
std::size_t SharedStore::Implementation::remove_jobs(const std::string& sequences, const Values&... values) {
  struct Removed {
    std::string id;
    std::int64_t fencing_token;
    std::int64_t bytes;
  };
  const auto removed = database.transaction([&](pqxx::work& transaction) {
    std::vector<Removed> jobs;
    for (const auto& row : transaction.exec_params(
             "DELETE FROM jobs WHERE sequence IN (" + sequences + ") RETURNING id, hold, bytes", values...))
      jobs.push_back({row[0].c_str(), integer_of(row[1]), integer_of(row[2])});
    return jobs;
  });
  for (const auto& job : removed) {
    remove_results_before(job.id, job.hold + 1);
    remove_file(paths.request(job.id));
    add(Category::results, -job.bytes);
  }
  return removed.size();
}

std::size_t SharedStore::Implementation::expire_oldest_results(std::int64_t bytes, const std::string& owner) {
  const auto expired = remove_jobs(
      "SELECT sequence FROM (SELECT sequence, sum(bytes) OVER (ORDER BY finished, sequence) - bytes AS before "
      "FROM jobs WHERE finished > 0 AND result_hash <> '' AND ($2 = '' OR owner = $2)) AS oldest WHERE before < $1",
      bytes, owner);
  if (expired > 0) {
    folder.warn(std::to_string(expired) + " finished jobs " + (owner.empty() ? "" : "of the key " + owner + " ") +
                "have expired to make room for others (" + (owner.empty() ? "--max-store" : "--max-stored") + ")");
  }
  return expired;
}

void SharedStore::Implementation::remove_results_before(const std::string& id, std::int64_t fencing_token) const {
  for (std::int64_t earlier = 0; earlier < fencing_token; ++earlier)
    remove_file(paths.result(shared_result_stem(id, earlier)));
}

bool SharedStore::Implementation::has_lease(const JobRecord& job) {
  return database.transaction([&](pqxx::work& transaction) {
    return !transaction
                .exec_params("SELECT 1 FROM jobs WHERE id = $1 AND finished = 0 AND holder = $2 AND hold = $3", job.id,
                             server, job.hold)
                .empty();
  });
}

bool SharedStore::Implementation::may_be_committed(const JobRecord& job, const std::string& hash) {
  try {
    return database.transaction([&](pqxx::work& transaction) {
      return !transaction
                  .exec_params("SELECT 1 FROM jobs WHERE id = $1 AND hold = $2 AND result_hash = $3", job.id, job.hold,
                               hash)
                  .empty();
    });
  } catch (const Error&) {
    return true;
  }
}

std::optional<JobRecord> SharedStore::Implementation::find_job(const char* condition, const std::string& value) {
  return database.transaction([&](pqxx::work& transaction) -> std::optional<JobRecord> {
    const auto rows =
        transaction.exec_params("SELECT " + shared_job_columns() + " FROM jobs WHERE " + condition, value);
    if (rows.empty()) return std::nullopt;
    return read_shared_job(rows[0]);
  });
}

std::string SharedStore::keep_request(const JobRecord& job, const JobRequest& request, std::string_view body) {
  auto& self = *implementation_;
  auto content = request_file(job, request).header(sha256(body));
  const auto bytes = static_cast<std::int64_t>(content.size() + body.size());
  self.make_room(Category::requests, bytes, job.owner, job.id);
  if (body.size() > max_request_in_database) {
    write_stored_file(self.paths.request(job.id), {content, body});
    return {};
  }
  return content.append(body);
}

void SharedStore::drop_request(const std::string& id) {
  Implementation::remove_file(implementation_->paths.request(id));
}

bool SharedStore::has_request(const std::string& id) const {
  std::error_code ignored;
  return fs::exists(implementation_->paths.request(id), ignored) ||
         implementation_->database.transaction([&](pqxx::work& transaction) {
           return !transaction.exec_params("SELECT 1 FROM jobs WHERE id = $1 AND request IS NOT NULL", id).empty();
         });
}

StoredRequest SharedStore::job_request(const std::string& id) const {
  auto in_database = implementation_->database.transaction([&](pqxx::work& transaction) -> std::optional<std::string> {
    const auto rows = transaction.exec_params("SELECT request FROM jobs WHERE id = $1 AND request IS NOT NULL", id);
    if (rows.empty()) return std::nullopt;
    return pqxx::binarystring(rows[0][0]).str();
  });
  auto bytes = in_database ? *std::move(in_database) : read_file(implementation_->paths.request(id));
  const auto file = RecordFile::parse(request_kind, bytes, id + ".request");
  bytes.erase(0, file.header_size());
  if (sha256(bytes) != file.body_hash()) throw_corrupted(id + ".request");
  return {request_of(file), std::move(bytes)};
}

bool SharedStore::add_job(const JobRecord& job, const std::string& request) {
  auto& self = *implementation_;
  const auto bytes = request.empty() ? bytes_of(self.paths.request(job.id)) : static_cast<std::int64_t>(request.size());
  const bool added = self.database.transaction([&](pqxx::work& transaction) {
    // If this transaction is run again, it adds nothing to what its first run has added.
    return insert_shared_job(transaction, job, bytes, self.server, request);
  });
  if (added && request.empty()) self.add(Category::requests, bytes);  // small requests count as part of the database
  return added;
}

bool SharedStore::note_progress(const JobRecord& job) {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    transaction.exec0("SET LOCAL synchronous_commit TO OFF");
    return transaction
               .exec_params(
                   "UPDATE jobs SET state = $2, started = $3, attempts = $4, revision = revision + 1, "
                   "holder = CASE WHEN $2 = 'accepted' THEN '' ELSE holder END "
                   "WHERE id = $1 AND finished = 0 AND holder = $5 AND hold = $6",
                   job.id, std::string(state_name(job.state)), job.started, job.attempts, implementation_->server,
                   job.hold)
               .affected_rows() > 0;
  });
}

bool SharedStore::finish_job(const JobRecord& job, const Result* result) {
  auto& self = *implementation_;
  const auto path = self.paths.result(shared_result_stem(job.id, job.hold));
  if (!self.has_lease(job)) return false;  // the job may have ended with this file, which then stays
  self.remove_results_before(job.id, job.hold);
  ResultFile file;
  bool updated = false;
  try {
    if (result) {
      file.hash = sha256(result->body);
      const auto header = result_file(job, *result).header(file.hash);
      file.bytes = static_cast<std::int64_t>(header.size() + result->body.size());
      self.make_room(Category::results, file.bytes, job.owner, job.id);
      write_stored_file(path, {header, result->body});
    }
    updated = self.database.transaction([&](pqxx::work& transaction) {
      const auto rows = transaction.exec_params(
          "UPDATE jobs SET state = $2, started = $3, finished = $4, expires = $5, error = $6, error_status = $7, "
          "attempts = $8, bytes = $9, result_type = $10, result_headers = $11, result_hash = $12, request = NULL, "
          "partial = '', revision = revision + 1 WHERE id = $1 AND finished = 0 AND holder = $13 AND hold = $14",
          job.id, std::string(state_name(job.state)), job.started, job.finished, job.expires, job.error,
          job.error_status, job.attempts, file.bytes, result ? result->content_type : std::string(),
          result ? join_headers(*result) : std::string(), file.hash, self.server, job.hold);
      return rows.affected_rows() > 0;
    });
  } catch (...) {
    // If the database was lost during the commit, it is unknown whether it has committed; then the file stays.
    if (result && !self.may_be_committed(job, file.hash)) Implementation::remove_file(path);
    throw;
  }
  if (updated) {
    drop_request(job.id);
    self.add(Category::results, file.bytes);
  } else {
    Implementation::remove_file(path);
  }
  return updated;
}

std::optional<JobRecord> SharedStore::job(const std::string& id) const {
  return implementation_->find_job("id = $1", id);
}

std::optional<JobRecord> SharedStore::job_of_key(const std::string& key) const {
  return implementation_->find_job("idempotency_key = $1", key);
}

std::vector<JobRecord> SharedStore::jobs(const std::vector<JobState>& states, std::size_t limit,
                                         const std::string& after, const std::string& owner) const {
  std::string names;  // constants of this program, which need no escaping in SQL
  for (const auto state : states) names.append(names.empty() ? "'" : ", '").append(state_name(state)).append("'");
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    std::vector<JobRecord> records;
    const auto rows = transaction.exec_params(
        "SELECT " + shared_job_columns() +
            " FROM jobs WHERE ($1 = '' OR sequence < (SELECT sequence FROM jobs WHERE id = $1))" +
            (states.empty() ? "" : " AND state IN (" + names + ")") +
            " AND ($3 = '' OR owner = $3) ORDER BY sequence DESC LIMIT $2",
        after, static_cast<std::int64_t>(limit), owner);
    for (const auto& row : rows) records.push_back(read_shared_job(row));
    return records;
  });
}

bool SharedStore::owns_job(const std::string& id, const std::string& owner) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    return !transaction.exec_params("SELECT 1 FROM jobs WHERE id = $1 AND owner = $2", id, owner).empty();
  });
}

StoredResult SharedStore::job_result(const std::string& id) const {
  Result row_of_result;
  std::string hash;
  std::int64_t fencing_token = 0;
  const bool found = implementation_->database.transaction([&](pqxx::work& transaction) {
    const auto rows =
        transaction.exec_params("SELECT result_type, result_headers, result_hash, hold FROM jobs WHERE id = $1", id);
    if (rows.empty()) return false;
    row_of_result = {};
    row_of_result.content_type = rows[0][0].c_str();
    split_headers(rows[0][1].c_str(), row_of_result);
    hash = rows[0][2].c_str();
    fencing_token = rows[0][3].as<std::int64_t>();
    return true;
  });
  const auto throw_no_job = [&] { throw Error("job.not_found", "There is no job " + id + "."); };
  if (!found) throw_no_job();
  try {
    return {std::move(row_of_result.content_type), std::move(row_of_result.headers),
            open_checked(implementation_->paths.result(shared_result_stem(id, fencing_token)), result_kind, hash, {})};
  } catch (const Error& error) {
    if (implementation_->was_removed(error, "jobs", id)) throw_no_job();
    throw;
  }
}

bool SharedStore::remove_job(const std::string& id) {
  return implementation_->remove_jobs("SELECT sequence FROM jobs WHERE id = $1 AND finished > 0", id) > 0;
}

std::vector<JobRecord> SharedStore::unfinished_jobs() const { return {}; }

std::size_t SharedStore::remove_expired_jobs(std::int64_t now, std::size_t max_count) {
  implementation_->quarantine_orphans();
  return implementation_->remove_jobs(
      "SELECT sequence FROM jobs WHERE finished > 0 AND (expires <= $1 OR sequence NOT IN "
      "(SELECT sequence FROM jobs WHERE finished > 0 ORDER BY sequence DESC LIMIT $2)) FOR UPDATE SKIP LOCKED",
      now, static_cast<std::int64_t>(max_count));
}

std::vector<JobRecord> SharedStore::take_jobs(std::size_t max_count) {
  auto& self = *implementation_;
  return self.database.transaction([&](pqxx::work& transaction) {
    std::vector<JobRecord> taken;
    const auto take = [&](const std::string& condition, std::size_t limit) {
      const auto rows = transaction.exec_params(
          "WITH free AS (SELECT id, sequence FROM jobs "
          "WHERE finished = 0 AND holder <> $1 AND " +
              condition +
              " ORDER BY sequence LIMIT $2 FOR UPDATE SKIP LOCKED), "
              "taken AS (UPDATE jobs SET holder = $1, hold = hold + 1, revision = revision + 1 FROM free "
              "WHERE jobs.id = free.id RETURNING jobs.*) SELECT " +
              shared_job_columns() + " FROM taken AS jobs ORDER BY sequence",
          self.server, static_cast<std::int64_t>(limit));
      for (const auto& row : rows) taken.push_back(read_shared_job(row));
    };
    // A join would not do. If another server has just taken a row, PostgreSQL evaluates the condition again, but a join
    // would still use the old row of "servers".
    take("coalesce((SELECT until FROM servers WHERE servers.id = holder), '-infinity') < now()",
         std::max(max_count, abandoned_jobs_per_call));
    if (max_count > taken.size()) take("state = 'accepted'", max_count - taken.size());
    return taken;
  });
}

std::optional<JobProgress> SharedStore::job_progress(const std::string& id) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) -> std::optional<JobProgress> {
    const auto rows = transaction.exec_params("SELECT progress, stage, partial, revision FROM jobs WHERE id = $1", id);
    if (rows.empty()) return std::nullopt;
    return JobProgress{id, rows[0][0].as<double>(), rows[0][1].c_str(), rows[0][2].c_str(),
                       rows[0][3].as<std::int64_t>()};
  });
}

std::optional<JobRecord> SharedStore::dismiss_job(const std::string& id, std::int64_t finished, std::int64_t expires) {
  const bool dismissed = implementation_->database.transaction([&](pqxx::work& transaction) {
    return transaction
               .exec_params(
                   "UPDATE jobs SET state = 'dismissed', finished = $2, expires = $3, request = NULL, bytes = 0, "
                   "hold = hold + 1, holder = '', partial = '', revision = revision + 1 WHERE id = $1 AND finished = 0",
                   id, finished, expires)
               .affected_rows() > 0;
  });
  if (!dismissed) return std::nullopt;
  drop_request(id);
  return job(id);
}

bool SharedStore::has_unfinished_job_on(const std::string& mesh) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    return !transaction.exec_params("SELECT 1 FROM jobs WHERE mesh = $1 AND finished = 0 LIMIT 1", mesh).empty();
  });
}

}  // namespace supple::store
