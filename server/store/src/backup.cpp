#include <sys/stat.h>

#include <set>

#include "data_folder.h"
#include "database.h"
#include "file_access.h"
#include "stored_files.h"
#include "supple/base/error.h"
#include "supple/store/maintenance.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Written last, so that a backup without it is known to be incomplete.
constexpr const char* marker = "backup";

void require_empty(const fs::path& folder) {
  if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder)))
    throw Error("store.unavailable", "There is something in " + folder.string() + " already.");
}

void make_folders(const Places& places) {
  for (const auto& folder : {places.folder, places.meshes(), places.results(), places.requests()}) {
    fs::create_directories(folder);
    fs::permissions(folder, fs::perms::owner_all);
  }
}

/// Makes `to` the database that `from` is at this moment, whoever writes to `from`.
void copy_database(const fs::path& from, const fs::path& to) {
  const Database source(from);
  const Database target(to);
  sqlite3_backup* const backup = sqlite3_backup_init(target.handle(), "main", source.handle(), "main");
  int status = backup ? SQLITE_OK : sqlite3_errcode(target.handle());
  constexpr int all_pages = -1;
  constexpr int milliseconds_between_tries = 20;
  constexpr int tries = 500;  // ten seconds
  for (int i = 0; backup && i < tries; ++i) {
    status = sqlite3_backup_step(backup, all_pages);
    if (status != SQLITE_BUSY && status != SQLITE_LOCKED) break;
    sqlite3_sleep(milliseconds_between_tries);
  }
  if (backup) sqlite3_backup_finish(backup);
  if (status != SQLITE_DONE) {
    throw Error(status == SQLITE_FULL ? "store.full" : "store.unavailable",
                "The database cannot be copied: " + std::string(sqlite3_errstr(status)) + ".");
  }
  // One file, not three, until a server opens it.
  Statement(target, "PRAGMA journal_mode = DELETE").run();
}

/// Copies a file with its times, which are those of a mesh whose database is lost.
std::int64_t copy_content(const fs::path& from, const fs::path& to, const std::string& content) {
  write_stored_file(to, {content});
  std::error_code ignored;
  fs::last_write_time(to, fs::last_write_time(from, ignored), ignored);
  return static_cast<std::int64_t>(content.size());
}

/// The files beside the database that are not of its making: whatever else is kept in a data folder.
std::vector<fs::path> other_files(const Places& places) {
  const auto database = places.database().string();
  const std::set<fs::path> left_out{database,         database + "-wal", database + "-shm",
                                    places.reserve(), places.lock(),     places.folder / marker};
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(places.folder)) {
    const auto& path = entry.path();
    const auto name = path.filename().string();
    if (!entry.is_regular_file() || left_out.contains(path) || is_unfinished(path)) continue;
    if (name.ends_with(".sqlite-wal") || name.ends_with(".sqlite-shm")) continue;
    others.push_back(path);
  }
  return others;
}

class Copier {
 public:
  Copier(const fs::path& from, const fs::path& to) : from_{from}, to_{to} {}

  /// Takes the database as it is now, and then the files that it names. Files do not change, but they go: those of jobs
  /// that end or are removed before their turn comes. So the database is taken again, and with it what has come
  /// meanwhile, until nothing is missing but what was missing before, which is a fault. Every round has less to copy.
  Copy run() {
    constexpr int most_rounds = 100;  // one is enough where nothing ends at the moment, two or three mostly
    std::set<fs::path> missing;
    bool again = true;
    for (int round = 0; again && round < most_rounds; ++round) {
      copy_database(from_.database(), to_.database());
      auto missing_now = copy_named_files();
      again = !missing_now.empty() && missing_now != missing;
      missing = std::move(missing_now);
    }
    for (const auto& path : missing)
      copy_.faults.push_back("The stored file " + path.filename().string() + " is missing.");
    remove_what_has_gone();
    for (const auto& path : other_files(from_)) {
      const auto to = to_.folder / path.filename();
      if (path.extension() == ".sqlite") {
        copy_database(path, to);
      } else {
        copy_.bytes += copy_content(path, to, read_file(path));
      }
      ++copy_.files;
    }
    copy_.bytes += bytes_of(to_.database());
    ++copy_.files;
    return copy_;
  }

 private:
  /// Copies the files of the copied database that have not been copied yet. Returns those that are not there.
  std::set<fs::path> copy_named_files() {
    std::set<fs::path> missing;
    std::vector<StoredFile> files;
    {
      const Database database(to_.database());
      files = stored_files(database);
    }
    wanted_.clear();
    for (const auto& file : files) {
      const auto to = file.place(to_);
      wanted_.insert(to);
      if (copied_.contains(to)) continue;
      const auto from = file.place(from_);
      if (!fs::exists(from)) {
        missing.insert(from);
        continue;
      }
      std::string content;
      try {
        content = read_file(from);
      } catch (const Error& error) {
        if (error.code() != "store.corrupted") throw;
        missing.insert(from);
        continue;
      }
      if (auto fault = fault_of(file, to.filename().string(), content); !fault.empty())
        copy_.faults.push_back(std::move(fault));
      copied_.emplace(to);
      copy_.bytes += copy_content(from, to, content);
      ++copy_.files;
    }
    return missing;
  }

  void remove_what_has_gone() {
    for (const auto& path : copied_) {
      if (wanted_.contains(path)) continue;
      copy_.bytes -= bytes_of(path);
      --copy_.files;
      fs::remove(path);
    }
  }

  const Places from_;
  const Places to_;
  std::set<fs::path> copied_;  ///< their places in the copy
  std::set<fs::path> wanted_;  ///< by the database that was taken last
  Copy copy_;
};

void require_database(const Places& places) {
  if (!fs::exists(places.database()))
    throw Error("store.unavailable", "There is no database in " + places.folder.string() + ".");
}

}  // namespace

Copy back_up(const fs::path& folder, const fs::path& to) {
  require_database({folder});
  require_empty(to);
  make_folders({to});
  auto copy = Copier(folder, to).run();
  write_stored_file(to / marker, {"supple-server backup of " + compact_time() + ": " + std::to_string(copy.files) +
                                  " files, " + std::to_string(copy.bytes) + " bytes\n"});
  return copy;
}

Copy restore(const fs::path& from, const fs::path& data, bool replace) {
  require_database({from});
  if (!fs::exists(from / marker)) {
    throw Error("store.unavailable",
                "The folder " + from.string() + " is no complete backup: it has no file named \"backup\".");
  }
  if (!replace) require_empty(data);
  const DataFolder folder(data, {});
  const auto& places = folder.places();
  const auto aside = places.quarantine() / (compact_time() + "-replaced");
  for (const auto& entry : fs::directory_iterator(data)) {
    const auto& path = entry.path();
    if (path == places.lock() || path == places.quarantine() || (entry.is_directory() && fs::is_empty(path))) continue;
    fs::create_directories(aside);
    fs::rename(path, aside / path.filename());
  }
  make_folders(places);
  return Copier(from, data).run();
}

}  // namespace supple::store
