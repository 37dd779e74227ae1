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
      places(folder.places()),
      database(options.database, options.patience),
      server(random_name()),
      look_at_files(static_cast<std::int64_t>(options.unknown_files * 1000)) {
  prepare_shared_tables(database, folder);
  say_alive();
  count();
}

void SharedStore::Implementation::say_alive() {
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
  of_all_servers = counted;
  counted_at = SteadyClock::now();
}

void SharedStore::Implementation::add(Part part, std::int64_t bytes) {
  const std::lock_guard lock(mutex);
  auto& all = of_all_servers;
  (part == Part::meshes ? all.meshes : part == Part::results ? all.results : all.requests) += bytes;
}

Usage SharedStore::Implementation::usage_now() const {
  const std::lock_guard lock(mutex);
  return of_all_servers;
}

bool SharedStore::Implementation::fits(Part part, std::int64_t bytes) const {
  try {
    return bytes_too_many(usage_now(), part, bytes) == 0;
  } catch (const Error&) {
    return false;
  }
}

void SharedStore::Implementation::make_room(Part part, std::int64_t bytes, const std::string& owner,
                                            const std::string& job) {
  if (!fits(part, bytes)) {
    // Other servers may have removed something since: nothing is refused, and nothing expires, by an old count.
    count();
    while (const auto too_many = bytes_too_many(usage_now(), part, bytes)) {
      const auto expired = expire_oldest_results(too_many, {});
      count();
      if (expired == 0 && !fits(part, bytes)) refuse_store(usage_now(), part, bytes);
    }
  }
  const auto limit = options.quota.of_owner && !owner.empty() ? options.quota.of_owner(owner) : 0;
  if (limit <= 0) return;
  const auto held = holding(owner, job);
  const auto too_many = held.total() + bytes - limit;
  if (too_many > held.results) refuse_owner(owner, held, part, bytes, limit);
  if (too_many > 0) expire_oldest_results(too_many, owner);
}

Holding SharedStore::Implementation::holding(const std::string& owner, const std::string& without_job) {
  return database.transaction([&](pqxx::work& transaction) {
    Holding holding;
    holding.meshes = transaction
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

bool SharedStore::Implementation::was_removed(const Error& fault, const std::string& table, const std::string& id) {
  return fault.code() == "store.corrupted" && database.transaction([&](pqxx::work& transaction) {
    return transaction.exec_params("SELECT 1 FROM " + table + " WHERE id = $1 FOR KEY SHARE", id).empty();
  });
}

void SharedStore::Implementation::look_at_unknown_files() {
  if (SteadyClock::now() < next_look_at_files) return;
  next_look_at_files = SteadyClock::now() + look_at_files;
  const auto names_of = [&](const char* query) {
    return database.transaction([&](pqxx::work& transaction) {
      std::map<std::string, bool> names;
      for (const auto& row : transaction.exec(query)) names.emplace(row[0].c_str(), true);
      return names;
    });
  };
  const auto before = now_milliseconds() - look_at_files.count();
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

void SharedStore::take_reserve() {}

Usage SharedStore::usage() const { return implementation_->usage_now(); }

std::vector<HeldJob> SharedStore::keep_holds(const std::vector<JobProgress>& running) {
  auto& self = *implementation_;
  std::map<std::string, std::int64_t> uses;
  bool counts = false;
  {
    const std::lock_guard lock(self.mutex);
    uses.swap(self.uses);
    counts = std::chrono::duration<double>(Implementation::SteadyClock::now() - self.counted_at).count() >
             self.options.count_again;
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

}  // namespace supple::store
