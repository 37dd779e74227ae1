#include "shared_state.h"

#include <exception>
#include <system_error>
#include <tuple>
#include <utility>

#include "file_access.h"
#include "shared_schema.h"

namespace supple::store {

namespace fs = std::filesystem;

SharedState::SharedState(const SharedStore::Options& given)
    : options(given),
      folder(options.folder, options.warn, DataFolder::Use::shared),
      paths(folder.paths()),
      database(options.database, options.transaction_timeout),
      server(random_id()),
      orphan_age(static_cast<std::int64_t>(options.orphan_age * 1000)) {
  prepare_shared_tables(database, folder);
  renew_server_lease();
  count();
}

void SharedState::renew_server_lease() {
  database.transaction([&](pqxx::work& transaction) {
    transaction.exec_params(
        "INSERT INTO servers (id, until) VALUES ($1, now() + $2 * interval '1 second') "
        "ON CONFLICT (id) DO UPDATE SET until = excluded.until",
        server, options.lease);
    transaction.exec0("DELETE FROM servers WHERE until < now() - interval '1 day'");
    return true;
  });
}

void SharedState::end_leases() noexcept {
  try {
    database.transaction([&](pqxx::work& transaction) {
      transaction.exec_params("DELETE FROM servers WHERE id = $1", server);
      return true;
    });
  } catch (const std::exception&) {
    // The lease of this server ends by itself.
  }
}

void SharedState::count() {
  auto counted = database.transaction([](pqxx::work& transaction) {
    Usage usage;
    usage.meshes = transaction.exec1("SELECT coalesce(sum(bytes), 0)::bigint FROM meshes")[0].as<std::int64_t>();
    const auto jobs = transaction.exec1(
        "SELECT coalesce(sum(bytes) FILTER (WHERE finished > 0), 0)::bigint, "
        "coalesce(sum(bytes) FILTER (WHERE finished = 0 AND request IS NULL), 0)::bigint, "
        "pg_database_size(current_database()) FROM jobs");
    usage.results = jobs[0].as<std::int64_t>();
    usage.requests = jobs[1].as<std::int64_t>();
    usage.database = jobs[2].as<std::int64_t>();
    return usage;
  });
  counted.limit = options.quota.bytes;
  counted.mesh_limit = options.quota.mesh_bytes;
  const std::lock_guard lock(mutex);
  usage_of_all_servers = counted;
  counted_at = SteadyClock::now();
}

bool SharedState::is_recount_due() const {
  const std::lock_guard lock(mutex);
  return std::chrono::duration<double>(SteadyClock::now() - counted_at).count() > options.recount_interval;
}

void SharedState::add(Category category, std::int64_t bytes) {
  const std::lock_guard lock(mutex);
  bytes_of_category(usage_of_all_servers, category) += bytes;
}

Usage SharedState::usage_now() const {
  const std::lock_guard lock(mutex);
  return usage_of_all_servers;
}

bool SharedState::fits(Category category, std::int64_t bytes) const {
  try {
    return excess_bytes(usage_now(), category, bytes) == 0;
  } catch (const Error&) {
    return false;
  }
}

void SharedState::make_room(Category category, std::int64_t bytes, const std::string& owner, const std::string& job) {
  if (!fits(category, bytes)) {
    // Other servers may have removed something since the last count. Nothing is refused, and nothing expires, because
    // of an old count.
    count();
    while (const auto excess = excess_bytes(usage_now(), category, bytes)) {
      const auto expired = expire_oldest_results(excess, {});
      count();
      if (expired == 0 && !fits(category, bytes)) refuse_store(usage_now(), category, bytes);
    }
  }
  const auto limit = options.quota.owner_limit && !owner.empty() ? options.quota.owner_limit(owner) : 0;
  if (limit <= 0) return;
  const auto owned = owner_usage(owner, job);
  const auto excess = owned.total() + bytes - limit;
  if (excess > owned.results) refuse_owner(owner, owned, category, bytes, limit);
  if (excess > 0) expire_oldest_results(excess, owner);
}

OwnerUsage SharedState::owner_usage(const std::string& owner, const std::string& without_job) {
  return database.transaction([&](pqxx::work& transaction) {
    OwnerUsage owner_usage;
    owner_usage.meshes =
        transaction
            .exec_params1(
                "SELECT coalesce(sum(bytes), 0)::bigint FROM mesh_owners JOIN meshes ON meshes.id = mesh "
                "WHERE owner = $1",
                owner)[0]
            .as<std::int64_t>();
    owner_usage.families =
        transaction.exec_params1("SELECT coalesce(sum(bytes), 0)::bigint FROM families WHERE owner = $1", owner)[0]
            .as<std::int64_t>();
    const auto jobs = transaction.exec_params1(
        "SELECT coalesce(sum(bytes) FILTER (WHERE finished > 0), 0)::bigint, "
        "coalesce(sum(bytes) FILTER (WHERE finished = 0), 0)::bigint FROM jobs WHERE owner = $1 AND id <> $2",
        owner, without_job);
    owner_usage.results = jobs[0].as<std::int64_t>();
    owner_usage.requests = jobs[1].as<std::int64_t>();
    return owner_usage;
  });
}

bool SharedState::was_removed(const std::string& table, const std::string& id) {
  return database.transaction([&](pqxx::work& transaction) {
    return transaction.exec_params("SELECT 1 FROM " + table + " WHERE id = $1 FOR KEY SHARE", id).empty();
  });
}

void SharedState::quarantine_orphans() {
  {
    const std::lock_guard lock(mutex);
    const auto now = SteadyClock::now();
    if (now < next_orphan_scan) return;
    next_orphan_scan = now + orphan_age;
  }
  const auto names_of = [&](const char* query) {
    return database.transaction([&](pqxx::work& transaction) {
      std::map<std::string, bool> names;
      for (const auto& row : transaction.exec(query)) names.emplace(row[0].c_str(), true);
      return names;
    });
  };
  const auto before = fs::file_time_type::clock::now() - orphan_age;
  for (const auto& [subfolder, suffix, query] :
       {std::tuple(paths.meshes(), ".ply", "SELECT id FROM meshes"),
        std::tuple(paths.results(), ".result", "SELECT id || '.' || hold FROM jobs"),
        std::tuple(paths.requests(), ".request", "SELECT id FROM jobs WHERE finished = 0")}) {
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(subfolder)) {
      std::error_code gone;  // another thread or server may have removed the file
      const bool is_old = fs::last_write_time(entry.path(), gone) < before;
      if (!gone && is_old && entry.is_regular_file(gone)) old.push_back(entry.path());
    }
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

void SharedState::remove_file(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
}

std::optional<MeshRecord> SharedState::find_mesh(const std::string& id) {
  return database.transaction([&](pqxx::work& transaction) { return find_mesh(transaction, id); });
}

std::optional<MeshRecord> SharedState::find_mesh(pqxx::work& transaction, const std::string& id) {
  const auto rows = transaction.exec_params("SELECT created, description FROM meshes WHERE id = $1", id);
  if (rows.empty()) return std::nullopt;
  return MeshRecord{id, rows[0][0].as<std::int64_t>(), rows[0][1].c_str()};
}

std::size_t SharedState::expire_oldest_results(std::int64_t bytes, const std::string& owner) {
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

void SharedState::remove_results_before(const std::string& id, std::int64_t fencing_token) const {
  for (std::int64_t earlier = 0; earlier < fencing_token; ++earlier)
    remove_file(paths.result(shared_result_stem(id, earlier)));
}

std::optional<JobRecord> SharedState::find_job(const char* condition, const std::string& value) {
  return database.transaction([&](pqxx::work& transaction) -> std::optional<JobRecord> {
    const auto rows =
        transaction.exec_params("SELECT " + shared_job_columns() + " FROM jobs WHERE " + condition, value);
    if (rows.empty()) return std::nullopt;
    return read_shared_job(rows[0]);
  });
}

}  // namespace supple::store
