#include "supple/store/shared_store.h"

#include <map>
#include <tuple>
#include <utility>

#include "file_access.h"
#include "shared_implementation.h"
#include "shared_schema.h"
#include "supple/base/error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

}  // namespace

SharedStore::Implementation::Implementation(const Options& given)
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

void SharedStore::Implementation::renew_server_lease() {
  database.transaction([&](pqxx::work& transaction) {
    transaction.exec_params(
        "INSERT INTO servers (id, until) VALUES ($1, now() + $2 * interval '1 second') "
        "ON CONFLICT (id) DO UPDATE SET until = excluded.until",
        server, options.lease);
    return true;
  });
}

void SharedStore::Implementation::count() {
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

void SharedStore::Implementation::add(Category category, std::int64_t bytes) {
  const std::lock_guard lock(mutex);
  auto& all = usage_of_all_servers;
  (category == Category::meshes ? all.meshes : category == Category::results ? all.results : all.requests) += bytes;
}

Usage SharedStore::Implementation::usage_now() const {
  const std::lock_guard lock(mutex);
  return usage_of_all_servers;
}

bool SharedStore::Implementation::fits(Category category, std::int64_t bytes) const {
  try {
    return excess_bytes(usage_now(), category, bytes) == 0;
  } catch (const Error&) {
    return false;
  }
}

void SharedStore::Implementation::make_room(Category category, std::int64_t bytes, const std::string& owner,
                                            const std::string& job) {
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
  const auto limit = options.quota.of_owner && !owner.empty() ? options.quota.of_owner(owner) : 0;
  if (limit <= 0) return;
  const auto owned = owner_usage(owner, job);
  const auto excess = owned.total() + bytes - limit;
  if (excess > owned.results) refuse_owner(owner, held, category, bytes, limit);
  if (excess > 0) expire_oldest_results(excess, owner);
}

OwnerUsage SharedStore::Implementation::owner_usage(const std::string& owner, const std::string& without_job) {
  return database.transaction([&](pqxx::work& transaction) {
    OwnerUsage owner_usage;
    owner_usage.meshes =
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
    owner_usage.results = jobs[0].as<std::int64_t>();
    owner_usage.requests = jobs[1].as<std::int64_t>();
    return owner_usage;
  });
}

bool SharedStore::Implementation::was_removed(const Error& fault, const std::string& table, const std::string& id) {
  return fault.code() == "store.corrupted" && database.transaction([&](pqxx::work& transaction) {
    return transaction.exec_params("SELECT 1 FROM " + table + " WHERE id = $1 FOR KEY SHARE", id).empty();
  });
}

void SharedStore::Implementation::quarantine_orphans() {
  if (SteadyClock::now() < next_orphan_scan) return;
  next_orphan_scan = SteadyClock::now() + orphan_age;
  const auto names_of = [&](const char* query) {
    return database.transaction([&](pqxx::work& transaction) {
      std::map<std::string, bool> names;
      for (const auto& row : transaction.exec(query)) names.emplace(row[0].c_str(), true);
      return names;
    });
  };
  const auto before = now_milliseconds() - orphan_age.count();
  for (const auto& [subfolder, suffix, query] :
       {std::tuple(paths.meshes(), ".ply", "SELECT id FROM meshes"),
        std::tuple(paths.results(), ".result", "SELECT id || '.' || hold FROM jobs"),
        std::tuple(paths.requests(), ".request", "SELECT id FROM jobs WHERE finished = 0")}) {
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(subfolder))
      if (entry.is_regular_file() && modification_time(entry.path()) < before) old.push_back(entry.path());
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

void SharedStore::Implementation::remove_file(const fs::path& file) {
  std::error_code ignored;
  fs::remove(file, ignored);
}

SharedStore::SharedStore(const Options& options) {
  try {
    implementation_ = std::make_unique<Implementation>(options);
  } catch (const fs::filesystem_error& error) {
    throw Error("store.unavailable",
                "The data folder " + options.folder.string() + " cannot be used: " + error.code().message() + ".");
  }
}

/// Gives up the leases of this server's jobs, so that others can take them at once.
SharedStore::~SharedStore() {
  if (!implementation_) return;
  try {
    implementation_->database.transaction([&](pqxx::work& transaction) {
      transaction.exec_params("DELETE FROM servers WHERE id = $1", implementation_->server);
      return true;
    });
  } catch (const Error&) {
    // The lease of this server ends by itself.
  }
}

void SharedStore::take_reserve() {}

Usage SharedStore::usage() const { return implementation_->usage_now(); }

std::vector<HeldJob> SharedStore::keep_holds(const std::vector<JobProgress>& running) {
  auto& self = *implementation_;
  std::map<std::string, std::int64_t> uses;
  bool recount_is_due = false;
  {
    const std::lock_guard lock(self.mutex);
    uses.swap(self.unwritten_uses);
    recount_is_due = std::chrono::duration<double>(Implementation::SteadyClock::now() - self.counted_at).count() >
                     self.options.recount_interval;
  }
  try {
    self.renew_server_lease();
    auto leased = self.database.transaction([&](pqxx::work& transaction) {
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
    if (recount_is_due) self.count();
    return leased;
  } catch (...) {
    const std::lock_guard lock(self.mutex);
    for (const auto& [id, when] : uses) self.unwritten_uses.emplace(id, when);
    throw;
  }
}

}  // namespace supple::store
