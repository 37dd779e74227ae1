#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "data_folder.h"
#include "postgres.h"
#include "space.h"
#include "supple/base/error.h"
#include "supple/store/shared_store.h"

namespace supple::store {

/// What meshes, jobs and holds of a shared store have in common.
struct SharedStore::Implementation {
  using SteadyClock = std::chrono::steady_clock;

  explicit Implementation(const Options& given);

  void say_alive();
  /// Counts what all servers hold.
  void count();
  void add(Part part, std::int64_t bytes);
  Usage usage_now() const;
  /// Whether so much fits by the last count.
  bool fits(Part part, std::int64_t bytes) const;
  /// Makes room for what is about to be written: all servers' oldest results go where there is too little, then the
  /// oldest ones of its owner. `job` is the one that the bytes are of. Throws "store.quota", "store.key_quota".
  void make_room(Part part, std::int64_t bytes, const std::string& owner, const std::string& job);
  Holding holding(const std::string& owner, const std::string& without_job);

  std::optional<MeshRecord> find_mesh(const std::string& id);
  static std::optional<MeshRecord> find_mesh(pqxx::work& transaction, const std::string& id);

  /// Removes the oldest finished jobs, of an owner alone where one is named, until their results have freed so many
  /// bytes. Returns how many there were.
  std::size_t expire_oldest_results(std::int64_t bytes, const std::string& owner);
  /// Removes the jobs whose sequence numbers a query selects. Their files go after the commit. Defined beside its
  /// callers, which are all in one file.
  template <class... Values>
  std::size_t remove_jobs(const std::string& sequences, const Values&... values);
  /// Removes the results of earlier holds: a server that was lost in the moment between its file and its row has left
  /// one. What it had half-written is left to look_at_unknown_files().
  void remove_results_before(const std::string& id, std::int64_t hold) const;
  /// Whether this server has the job, which has not ended.
  bool holds(const JobRecord& job);
  /// Whether the database has ended the job with this result, or cannot be asked.
  bool is_result_of(const JobRecord& job, const std::string& hash);
  /// One job, by a condition with one parameter.
  std::optional<JobRecord> find_job(const char* condition, const std::string& value);

  /// Where a file is missing, or is not what its row says: whether it is because another server is removing both. Waits
  /// for that one's commit. `table` is "meshes" or "jobs".
  bool was_removed(const Error& fault, const std::string& table, const std::string& id);

  /// Moves what nobody knows into quarantine, once in a while. What is younger than that may be about to be known.
  void look_at_unknown_files();
  static void remove_file(const std::filesystem::path& file);

  const Options options;
  const DataFolder folder;
  const Places& places;
  Postgres database;
  const std::string server;  ///< the name of this one, of this process
  mutable std::mutex mutex;
  Usage of_all_servers;
  SteadyClock::time_point counted_at{};
  const std::chrono::milliseconds look_at_files;  ///< time between two looks at what nobody knows
  SteadyClock::time_point next_look_at_files = SteadyClock::now() + look_at_files;
  std::map<std::string, std::int64_t> uses;              ///< of meshes, since the database was told last
  std::map<std::string, SteadyClock::time_point> known;  ///< meshes that the database had at that time
};

}  // namespace supple::store
