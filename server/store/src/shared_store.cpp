#include "supple/store/shared_store.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <system_error>
#include <utility>

#include "checked_content.h"
#include "data_folder.h"
#include "file_access.h"
#include "owner_table.h"
#include "postgres.h"
#include "record_file.h"
#include "shared_schema.h"
#include "space.h"
#include "supple/base/error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;
using SteadyClock = std::chrono::steady_clock;

/// Jobs of lost servers that one call takes at most, so that all that are left have their share of them.
constexpr std::size_t orphans_at_a_time = 8;

constexpr std::chrono::seconds count_again{5};  // what all servers hold
constexpr std::chrono::seconds ask_again{1};    // whether a mesh is still there
constexpr std::chrono::hours look_at_files{1};  // of the folder that nobody knows

/// The name of a result's file: of a hold, so that a server which has lost the job writes beside it.
std::string result_name(const std::string& id, std::int64_t hold) { return id + "." + std::to_string(hold); }

std::int64_t integer_of(const pqxx::field& field) { return field.as<std::int64_t>(); }

std::string owned_by(const char* parameter) {
  const std::string value(parameter);
  return "(" + value + " = '' OR EXISTS (SELECT 1 FROM mesh_owners WHERE mesh = meshes.id AND owner = " + value + "))";
}

}  // namespace

struct SharedStore::Implementation {
  explicit Implementation(const Options& given)
      : options(given),
        folder(options.folder, options.warn, DataFolder::Use::shared),
        places(folder.places()),
        database(options.database),
        server(random_name()) {
    prepare_shared_tables(database, folder);
    say_alive();
    count();
  }

  void say_alive() {
    database.transaction([&](pqxx::work& transaction) {
      transaction.exec_params(
          "INSERT INTO servers (id, until) VALUES ($1, now() + $2 * interval '1 second') "
          "ON CONFLICT (id) DO UPDATE SET until = excluded.until",
          server, options.lease);
      return true;
    });
  }

  /// Counts what all servers hold.
  void count() {
    auto counted = database.transaction([](pqxx::work& transaction) {
      Usage usage;
      usage.meshes = transaction.exec1("SELECT coalesce(sum(bytes), 0)::bigint FROM meshes")[0].as<std::int64_t>();
      const auto jobs = transaction.exec1(
          "SELECT coalesce(sum(bytes) FILTER (WHERE finished > 0), 0)::bigint, "
          "coalesce(sum(bytes) FILTER (WHERE finished = 0), 0)::bigint, "
          "pg_database_size(current_database()) FROM jobs");
      usage.results = jobs[0].as<std::int64_t>();
      usage.requests = jobs[1].as<std::int64_t>();
      usage.database = jobs[2].as<std::int64_t>();
      return usage;
    });
    counted.limit = options.quota.bytes;
    counted.mesh_limit = options.quota.mesh_bytes;
    const std::lock_guard lock(mutex);
    of_all_servers = counted;
    counted_at = SteadyClock::now();
  }

  void add(Part part, std::int64_t bytes) {
    const std::lock_guard lock(mutex);
    auto& all = of_all_servers;
    (part == Part::meshes ? all.meshes : part == Part::results ? all.results : all.requests) += bytes;
  }

  Usage usage_now() const {
    const std::lock_guard lock(mutex);
    return of_all_servers;
  }

  /// Makes room for what is about to be written: all servers' oldest results go where there is too little, then the
  /// oldest ones of its owner. `job` is the one that the bytes are of. Throws "store.quota", "store.key_quota".
  void make_room(Part part, std::int64_t bytes, const std::string& owner, const std::string& job) {
    while (const auto too_many = bytes_too_many(usage_now(), part, bytes)) {
      const auto expired = expire_oldest_results(too_many, {});
      count();
      if (expired == 0) refuse_store(usage_now(), part, bytes);
    }
    const auto limit = options.quota.of_owner && !owner.empty() ? options.quota.of_owner(owner) : 0;
    if (limit <= 0) return;
    const auto held = holding(owner, job);
    const auto too_many = held.total() + bytes - limit;
    if (too_many > held.results) refuse_owner(owner, held, part, bytes, limit);
    if (too_many > 0) expire_oldest_results(too_many, owner);
  }

  Holding holding(const std::string& owner, const std::string& without_job) {
    return database.transaction([&](pqxx::work& transaction) {
      Holding holding;
      holding.meshes =
          transaction
              .exec_params1(
                  "SELECT coalesce(sum(bytes), 0)::bigint FROM mesh_owners JOIN meshes ON meshes.id = mesh "
                  "WHERE owner = $1",
                  owner)[0]
              .as<std::int64_t>();
      const auto jobs = transaction.exec_params1(
          "SELECT coalesce(sum(bytes) FILTER (WHERE finished > 0), 0)::bigint, "
          "coalesce(sum(bytes) FILTER (WHERE finished = 0), 0)::bigint FROM jobs WHERE owner = $1 AND id <> $2",
          owner, without_job);
      holding.results = jobs[0].as<std::int64_t>();
      holding.requests = jobs[1].as<std::int64_t>();
      return holding;
    });
  }

  /// Removes the oldest finished jobs, of an owner alone where one is named, until their results have freed so many
  /// bytes. Returns how many there were.
  std::size_t expire_oldest_results(std::int64_t bytes, const std::string& owner) {
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

  /// Removes the jobs whose sequence numbers a query selects. Their files go after the commit.
  template <class... Values>
  std::size_t remove_jobs(const std::string& sequences, const Values&... values) {
    struct Removed {
      std::string id;
      std::int64_t hold;
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
      remove_file(places.request(job.id));
      add(Part::results, -job.bytes);
    }
    return removed.size();
  }

  /// Removes the files of earlier holds: a server that was lost in the moment between its file and its row has left
  /// one.
  void remove_results_before(const std::string& id, std::int64_t hold) const {
    for (std::int64_t earlier = 0; earlier < hold; ++earlier) remove_file(places.result(result_name(id, earlier)));
  }

  static void remove_file(const fs::path& file) {
    std::error_code ignored;
    fs::remove(file, ignored);
  }

  std::optional<MeshRecord> find_mesh(const std::string& id) {
    return database.transaction([&](pqxx::work& transaction) { return find_mesh(transaction, id); });
  }
  static std::optional<MeshRecord> find_mesh(pqxx::work& transaction, const std::string& id) {
    const auto rows = transaction.exec_params("SELECT created, description FROM meshes WHERE id = $1", id);
    if (rows.empty()) return std::nullopt;
    return MeshRecord{id, rows[0][0].as<std::int64_t>(), rows[0][1].c_str()};
  }

  /// Whether this server has the job, which has not ended.
  bool holds(const JobRecord& job) {
    return database.transaction([&](pqxx::work& transaction) {
      return !transaction
                  .exec_params("SELECT 1 FROM jobs WHERE id = $1 AND finished = 0 AND holder = $2 AND hold = $3",
                               job.id, server, job.hold)
                  .empty();
    });
  }

  /// Whether the database has ended the job with this result, or cannot be asked.
  bool is_result_of(const JobRecord& job, const std::string& hash) {
    try {
      return database.transaction([&](pqxx::work& transaction) {
        return !transaction
                    .exec_params("SELECT 1 FROM jobs WHERE id = $1 AND hold = $2 AND result_hash = $3", job.id,
                                 job.hold, hash)
                    .empty();
      });
    } catch (const Error&) {
      return true;
    }
  }

  /// One job, by a condition with one parameter.
  std::optional<JobRecord> find_job(const char* condition, const std::string& value) {
    return database.transaction([&](pqxx::work& transaction) -> std::optional<JobRecord> {
      const auto rows =
          transaction.exec_params("SELECT " + shared_job_columns() + " FROM jobs WHERE " + condition, value);
      if (rows.empty()) return std::nullopt;
      return read_shared_job(rows[0]);
    });
  }

  /// Moves what nobody knows into quarantine, by one server at a time. What is younger than an hour may be about to be
  /// known.
  void look_at_unknown_files() {
    if (SteadyClock::now() < next_look_at_files) return;
    next_look_at_files = SteadyClock::now() + look_at_files;
    const auto names_of = [&](const char* query) {
      return database.transaction([&](pqxx::work& transaction) {
        std::map<std::string, bool> names;
        for (const auto& row : transaction.exec(query)) names.emplace(row[0].c_str(), true);
        return names;
      });
    };
    const auto before =
        now_milliseconds() - std::chrono::duration_cast<std::chrono::milliseconds>(look_at_files).count();
    for (const auto& [place, suffix, query] :
         {std::tuple(places.meshes(), ".ply", "SELECT id FROM meshes"),
          std::tuple(places.results(), ".result", "SELECT id || '.' || hold FROM jobs"),
          std::tuple(places.requests(), ".request", "SELECT id FROM jobs WHERE finished = 0")}) {
      std::vector<fs::path> old;
      for (const auto& entry : fs::directory_iterator(place))
        if (entry.is_regular_file() && modified(entry.path()) < before) old.push_back(entry.path());
      if (old.empty()) continue;
      const auto names = names_of(query);
      for (const auto& path : old) {
        if (is_unfinished(path)) {
          remove_file(path);
        } else if (path.extension() != suffix || !names.contains(path.stem().string())) {
          folder.try_to_quarantine(path);
        }
      }
    }
  }

  const Options options;
  const DataFolder folder;
  const Places& places;
  Postgres database;
  const std::string server;  ///< the name of this one, of this process
  mutable std::mutex mutex;
  Usage of_all_servers;
  SteadyClock::time_point counted_at{};
  SteadyClock::time_point next_look_at_files = SteadyClock::now() + look_at_files;
  std::map<std::string, std::int64_t> uses;              ///< of meshes, since the database was told last
  std::map<std::string, SteadyClock::time_point> known;  ///< meshes that the database had at that time
};

SharedStore::SharedStore(const Options& options) {
  try {
    implementation_ = std::make_unique<Implementation>(options);
  } catch (const fs::filesystem_error& error) {
    throw Error("store.unavailable",
                "The data folder " + options.folder.string() + " cannot be used: " + error.code().message() + ".");
  }
}

/// Its jobs are free at once.
SharedStore::~SharedStore() {
  if (!implementation_) return;
  try {
    implementation_->database.transaction([&](pqxx::work& transaction) {
      transaction.exec_params("DELETE FROM servers WHERE id = $1", implementation_->server);
      return true;
    });
  } catch (const Error&) {
    // Its lease ends by itself.
  }
}

std::pair<MeshRecord, bool> SharedStore::add_mesh(const std::string& ply, const DescribeMesh& describe,
                                                  const std::string& owner) {
  auto& self = *implementation_;
  const auto bytes = static_cast<std::int64_t>(ply.size());
  MeshRecord record;
  record.id = sha256(ply);
  const auto file = self.places.mesh(record.id);
  if (auto known = self.find_mesh(record.id)) {
    record = *std::move(known);
    use_mesh(record.id);
    // Uploading again repairs a file that has been damaged.
    try {
      open_mesh_content(record.id);
    } catch (const Error&) {
      write_stored_file(file, {ply});
    }
    if (!owner.empty() && !owns_mesh(record.id, owner)) self.make_room(Part::meshes, bytes, owner, {});
  } else {
    record.created = now_milliseconds();
    record.description = describe(record.id, record.created);
    self.make_room(Part::meshes, bytes, owner, {});
    write_stored_file(file, {ply});
  }
  auto added = self.database.transaction([&](pqxx::work& transaction) -> std::pair<MeshRecord, bool> {
    // Waits for a server that removes the same mesh, which removes the file before it commits.
    const bool is_new =
        transaction
            .exec_params(
                "INSERT INTO meshes (id, created, used, bytes, description) VALUES ($1, $2, $2, $3, $4) "
                "ON CONFLICT (id) DO NOTHING",
                record.id, record.created, bytes, record.description)
            .affected_rows() > 0;
    bool is_new_owner = false;
    if (!owner.empty()) {
      is_new_owner = transaction
                         .exec_params("INSERT INTO mesh_owners (mesh, owner) VALUES ($1, $2) ON CONFLICT DO NOTHING",
                                      record.id, owner)
                         .affected_rows() > 0;
    }
    if (bytes_of(file) != bytes) write_stored_file(file, {ply});
    auto stored = Implementation::find_mesh(transaction, record.id);
    return {stored ? *std::move(stored) : record, is_new || is_new_owner};
  });
  if (added.second) self.add(Part::meshes, bytes);
  return added;
}

std::optional<MeshRecord> SharedStore::mesh(const std::string& id) const { return implementation_->find_mesh(id); }

std::vector<MeshRecord> SharedStore::meshes(std::size_t limit, const std::string& after,
                                            const std::string& owner) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    std::vector<MeshRecord> records;
    const auto rows = transaction.exec_params(
        "SELECT id, created, description FROM meshes WHERE ($1 = '' OR sequence < (SELECT sequence FROM meshes WHERE "
        "id = $1)) AND " +
            owned_by("$3") + " ORDER BY sequence DESC LIMIT $2",
        after, static_cast<std::int64_t>(limit), owner);
    for (const auto& row : rows) records.push_back({row[0].c_str(), row[1].as<std::int64_t>(), row[2].c_str()});
    return records;
  });
}

std::string SharedStore::mesh_content(const std::string& id, const CancellationToken& cancellation) const {
  if (!mesh(id)) throw Error("mesh.not_found", "There is no mesh " + id + ".");
  auto bytes = read_file(implementation_->places.mesh(id), cancellation);
  if (sha256(bytes, cancellation) != id) throw_changed(id + ".ply");
  return bytes;
}

OpenContent SharedStore::open_mesh_content(const std::string& id, const CancellationToken& cancellation) const {
  if (!mesh(id)) throw Error("mesh.not_found", "There is no mesh " + id + ".");
  return open_checked(implementation_->places.mesh(id), {}, id, cancellation);
}

bool SharedStore::remove_mesh(const std::string& id, const std::string& owner) {
  auto& self = *implementation_;
  return self.database.transaction([&](pqxx::work& transaction) {
    // The row of the mesh is locked first, so that of two last owners one is the last.
    const auto rows = transaction.exec_params("SELECT bytes FROM meshes WHERE id = $1 FOR UPDATE", id);
    if (rows.empty()) return false;
    if (!owner.empty()) {
      const auto owners = transaction.exec_params("DELETE FROM mesh_owners WHERE mesh = $1 AND owner = $2", id, owner);
      if (owners.affected_rows() == 0) return false;
      if (!transaction.exec_params("SELECT 1 FROM mesh_owners WHERE mesh = $1 LIMIT 1", id).empty()) return true;
    }
    transaction.exec_params("DELETE FROM meshes WHERE id = $1", id);
    Implementation::remove_file(self.places.mesh(id));
    self.add(Part::meshes, -rows[0][0].as<std::int64_t>());
    return true;
  });
}

bool SharedStore::owns_mesh(const std::string& id, const std::string& owner) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    return !transaction.exec_params("SELECT 1 FROM mesh_owners WHERE mesh = $1 AND owner = $2", id, owner).empty();
  });
}

bool SharedStore::is_last_owner_of_mesh(const std::string& id, const std::string& owner) const {
  return implementation_->database.transaction([&](pqxx::work& transaction) {
    const auto row = transaction.exec_params1(
        "SELECT count(*), count(*) FILTER (WHERE owner = $2) FROM mesh_owners WHERE mesh = $1", id, owner);
    return row[0].as<int>() == 1 && row[1].as<int>() == 1;
  });
}

void SharedStore::use_mesh(const std::string& id) const {
  const std::lock_guard lock(implementation_->mutex);
  implementation_->uses[id] = now_milliseconds();
}

std::vector<std::string> SharedStore::remove_unused_meshes(std::int64_t before) {
  auto& self = *implementation_;
  keep_holds({});  // tells the uses
  return self.database.transaction([&](pqxx::work& transaction) {
    std::vector<std::string> ids;
    const auto rows = transaction.exec_params(
        "DELETE FROM meshes WHERE used < $1 AND NOT EXISTS "
        "(SELECT 1 FROM jobs WHERE jobs.mesh = meshes.id AND finished = 0) RETURNING id",
        before);
    for (const auto& row : rows) ids.emplace_back(row[0].c_str());
    for (const auto& id : ids) Implementation::remove_file(self.places.mesh(id));
    return ids;
  });
}

std::string SharedStore::keep_request(const JobRecord& job, const JobRequest& request, std::string_view body) {
  auto& self = *implementation_;
  auto content = request_file(job, request).header(sha256(body));
  const auto bytes = static_cast<std::int64_t>(content.size() + body.size());
  self.make_room(Part::requests, bytes, job.owner, job.id);
  if (body.size() > largest_request_in_database) {
    write_stored_file(self.places.request(job.id), {content, body});
    return {};
  }
  return content.append(body);
}

void SharedStore::drop_request(const std::string& id) {
  Implementation::remove_file(implementation_->places.request(id));
}

bool SharedStore::has_request(const std::string& id) const {
  std::error_code ignored;
  return fs::exists(implementation_->places.request(id), ignored) ||
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
  auto bytes = in_database ? *std::move(in_database) : read_file(implementation_->places.request(id));
  const auto file = RecordFile::parse(request_kind, bytes, id + ".request");
  bytes.erase(0, file.header_size());
  if (sha256(bytes) != file.body_hash()) throw_changed(id + ".request");
  return {request_of(file), std::move(bytes)};
}

bool SharedStore::add_job(const JobRecord& job, const std::string& request) {
  auto& self = *implementation_;
  const auto bytes =
      request.empty() ? bytes_of(self.places.request(job.id)) : static_cast<std::int64_t>(request.size());
  const bool added = self.database.transaction([&](pqxx::work& transaction) {
    // A second run of this transaction adds nothing to what a first one has added.
    const auto rows = transaction.exec_params(
        "INSERT INTO jobs (id, kind, mesh, state, created, started, finished, expires, deadline, error, error_status, "
        "client, session, owner, attempts, idempotency_key, request_hash, bytes, holder, hold) VALUES ($1, $2, $3, $4, "
        "$5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20) ON CONFLICT DO NOTHING",
        job.id, job.kind, job.mesh, std::string(state_name(job.state)), job.created, job.started, job.finished,
        job.expires, job.deadline, job.error, job.error_status, job.client, job.session, job.owner, job.attempts,
        job.idempotency_key, job.request_hash, bytes, self.server, job.hold);
    if (rows.affected_rows() == 0) return false;
    if (!request.empty()) {
      transaction.exec_params("UPDATE jobs SET request = $2 WHERE id = $1", job.id,
                              pqxx::binarystring(request.data(), request.size()));
    }
    return true;
  });
  if (added) self.add(Part::requests, bytes);
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
  const auto path = self.places.result(result_name(job.id, job.hold));
  if (!self.holds(job)) return false;  // its file may be there, and stays
  ResultFile file;
  bool known = false;
  try {
    if (result) {
      file.hash = sha256(result->body);
      const auto header = result_file(job, *result).header(file.hash);
      file.bytes = static_cast<std::int64_t>(header.size() + result->body.size());
      self.make_room(Part::results, file.bytes, job.owner, job.id);
      write_stored_file(path, {header, result->body});
    }
    known = self.database.transaction([&](pqxx::work& transaction) {
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
    // Whether the database has committed is not known where it was lost in that moment: then the file stays.
    if (result && !self.is_result_of(job, file.hash)) Implementation::remove_file(path);
    throw;
  }
  if (known) {
    self.remove_results_before(job.id, job.hold);
    drop_request(job.id);
    self.add(Part::results, file.bytes);
  } else {
    Implementation::remove_file(path);
  }
  return known;
}

std::optional<JobRecord> SharedStore::job(const std::string& id) const {
  return implementation_->find_job("id = $1", id);
}

std::optional<JobRecord> SharedStore::job_of_key(const std::string& key) const {
  return implementation_->find_job("idempotency_key = $1", key);
}

std::vector<JobRecord> SharedStore::jobs(const std::vector<JobState>& states, std::size_t limit,
                                         const std::string& after, const std::string& owner) const {
  std::string names;  // of ours, so that they can be part of the statement
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
  Result kept;
  std::string hash;
  std::int64_t hold = 0;
  const bool known = implementation_->database.transaction([&](pqxx::work& transaction) {
    const auto rows =
        transaction.exec_params("SELECT result_type, result_headers, result_hash, hold FROM jobs WHERE id = $1", id);
    if (rows.empty()) return false;
    kept = {};
    kept.content_type = rows[0][0].c_str();
    split_headers(rows[0][1].c_str(), kept);
    hash = rows[0][2].c_str();
    hold = rows[0][3].as<std::int64_t>();
    return true;
  });
  if (!known) throw Error("job.not_found", "There is no job " + id + ".");
  return {std::move(kept.content_type), std::move(kept.headers),
          open_checked(implementation_->places.result(result_name(id, hold)), result_kind, hash, {})};
}

bool SharedStore::remove_job(const std::string& id) {
  return implementation_->remove_jobs("SELECT sequence FROM jobs WHERE id = $1 AND finished > 0", id) > 0;
}

std::vector<JobRecord> SharedStore::unfinished_jobs() const { return {}; }

std::size_t SharedStore::remove_expired_jobs(std::int64_t now, std::size_t most) {
  implementation_->look_at_unknown_files();
  return implementation_->remove_jobs(
      "SELECT sequence FROM jobs WHERE finished > 0 AND (expires <= $1 OR sequence NOT IN "
      "(SELECT sequence FROM jobs WHERE finished > 0 ORDER BY sequence DESC LIMIT $2)) FOR UPDATE SKIP LOCKED",
      now, static_cast<std::int64_t>(most));
}

void SharedStore::take_reserve() {}

Usage SharedStore::usage() const { return implementation_->usage_now(); }

std::vector<HeldJob> SharedStore::keep_holds(const std::vector<JobProgress>& running) {
  auto& self = *implementation_;
  std::map<std::string, std::int64_t> uses;
  bool counts = false;
  {
    const std::lock_guard lock(self.mutex);
    uses.swap(self.uses);
    counts = SteadyClock::now() - self.counted_at > count_again;
  }
  try {
    self.say_alive();
    auto held = self.database.transaction([&](pqxx::work& transaction) {
      transaction.exec0("SET LOCAL synchronous_commit TO OFF");
      for (const auto& [id, when] : uses)
        transaction.exec_params("UPDATE meshes SET used = greatest(used, $2) WHERE id = $1", id, when);
      for (const auto& job : running) {
        transaction.exec_params(
            "UPDATE jobs SET progress = $2, stage = $3, partial = $4, revision = revision + 1 "
            "WHERE id = $1 AND finished = 0 AND holder = $5",
            job.id, job.fraction, job.stage, job.partial, self.server);
      }
      transaction.exec0("DELETE FROM servers WHERE until < now() - interval '1 day'");
      std::vector<HeldJob> jobs;
      for (const auto& row :
           transaction.exec_params("SELECT id, hold FROM jobs WHERE holder = $1 AND finished = 0", self.server))
        jobs.push_back({row[0].c_str(), row[1].as<std::int64_t>()});
      return jobs;
    });
    if (counts) self.count();
    return held;
  } catch (...) {
    const std::lock_guard lock(self.mutex);
    for (const auto& [id, when] : uses) self.uses.emplace(id, when);
    throw;
  }
}

std::vector<JobRecord> SharedStore::take_jobs(std::size_t most) {
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
    // No join: of a row that another server has just taken PostgreSQL looks at the condition again, but not at the row
    // that it was joined with before.
    take("coalesce((SELECT until FROM servers WHERE servers.id = holder), '-infinity') < now()",
         std::max(most, orphans_at_a_time));
    if (most > taken.size()) take("state = 'accepted'", most - taken.size());
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

bool SharedStore::still_has_mesh(const std::string& id) const {
  auto& self = *implementation_;
  const auto now = SteadyClock::now();
  {
    const std::lock_guard lock(self.mutex);
    const auto found = self.known.find(id);
    if (found != self.known.end() && now - found->second < ask_again) return true;
  }
  const bool there = self.find_mesh(id).has_value();
  const std::lock_guard lock(self.mutex);
  if (there) {
    self.known[id] = now;
  } else {
    self.known.erase(id);
  }
  return there;
}

}  // namespace supple::store
