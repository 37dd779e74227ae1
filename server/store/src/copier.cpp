#include "copier.h"

#include "database.h"
#include "file_access.h"
#include "record_file.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Copies a file with its time of modification, from which the age of a mesh is known if its database is lost.
std::int64_t copy_content(const fs::path& from, const fs::path& to, const std::string& content) {
  write_stored_file(to, {content});
  std::error_code ignored;
  fs::last_write_time(to, fs::last_write_time(from, ignored), ignored);
  return static_cast<std::int64_t>(content.size());
}

/// The files of a data folder that are neither stored content nor made with the database.
std::vector<fs::path> other_files(const DataPaths& paths) {
  const auto database = paths.database().string();
  const std::set<fs::path> excluded{database,     database + "-wal",     database + "-shm",    paths.reserve(),
                                    paths.lock(), paths.backup_marker(), paths.shared_marker()};
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(paths.folder)) {
    const auto& path = entry.path();
    const auto name = path.filename().string();
    if (!entry.is_regular_file() || excluded.contains(path) || is_unfinished(path)) continue;
    if (name.ends_with(".sqlite-wal") || name.ends_with(".sqlite-shm")) continue;
    others.push_back(path);
  }
  return others;
}

}  // namespace

void require_empty(const fs::path& folder) {
  if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder)))
    throw StoreUnavailable("There is something in " + folder.string() + " already.");
}

void make_folders(const DataPaths& paths) {
  for (const auto& folder : {paths.folder, paths.meshes(), paths.results(), paths.requests()}) {
    fs::create_directories(folder);
    fs::permissions(folder, fs::perms::owner_all);
  }
}

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
    const auto message = "The database cannot be copied: " + std::string(sqlite3_errstr(status)) + ".";
    if (status == SQLITE_FULL) throw StoreFull(message);
    throw StoreUnavailable(message);
  }
  // The copy is one file without log and index until a server opens it.
  Statement(target, "PRAGMA journal_mode = DELETE").run();
}

CopyReport Copier::finish(const std::vector<StoredFile>& missing) {
  for (const auto& file : missing) copy_.faults.push_back(missing_file_message(file.path(from_).filename().string()));
  remove_obsolete_copies();
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

std::vector<StoredFile> Copier::copy_files(const std::vector<StoredFile>& files) {
  std::vector<StoredFile> missing;
  current_.clear();
  for (const auto& file : files) {
    auto copy = file;
    copy.stem = stem_(file);
    const auto to = copy.path(to_);
    current_.insert(to);
    if (copied_.contains(to)) continue;
    const auto from = file.path(from_);
    if (!fs::exists(from)) {
      missing.push_back(file);
      continue;
    }
    std::string content;
    try {
      content = read_file(from);
    } catch (const StoreCorrupted&) {
      missing.push_back(file);  // it was removed meanwhile
      continue;
    }
    if (auto fault = fault_of(file, from.filename().string(), content); !fault.empty())
      copy_.faults.push_back(std::move(fault));
    copied_.emplace(to);
    copy_.bytes += copy_content(from, to, content);
    ++copy_.files;
  }
  return missing;
}

void Copier::remove_obsolete_copies() {
  for (const auto& path : copied_) {
    if (current_.contains(path)) continue;
    copy_.bytes -= bytes_of(path);
    --copy_.files;
    fs::remove(path);
  }
}

}  // namespace supple::store
