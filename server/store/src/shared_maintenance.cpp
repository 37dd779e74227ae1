#include <algorithm>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include "backup_marker.h"
#include "copier.h"
#include "data_folder.h"
#include "file_access.h"
#include "file_check.h"
#include "postgres.h"
#include "replaced_content.h"
#include "schema.h"
#include "shared_rows.h"
#include "shared_schema.h"
#include "supple/store/maintenance.h"
#include "supple/store/shared_store.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// The database of a shared store, for long transactions that read all rows.
class MaintenanceDatabase {
 public:
  explicit MaintenanceDatabase(const SharedStoreLocation& store)
      : database_(std::make_unique<Postgres>(store.database, max_seconds)) {}

  /// Does what Postgres::transaction does, without the time limits of a server.
  template <class Work>
  auto transaction(const Work& work) {
    return database_->transaction([&](pqxx::work& transaction) {
      transaction.exec0("SET LOCAL statement_timeout = 0");
      transaction.exec0("SET LOCAL idle_in_transaction_session_timeout = 0");
      return work(transaction);
    });
  }

  /// The files that the rows name, read again by each call. This object must outlive the catalogue.
  Catalogue catalogue() {
    return {[this] { return transaction([](pqxx::work& rows) { return shared_files(rows); }); },
            [this](const StoredFile& file) {
              return transaction([&](pqxx::work& rows) { return is_named_by_shared_rows(rows, file); });
            }};
  }

  void require_store(const DataPaths& paths) {
    transaction([&](pqxx::work& rows) {
      require_shared_tables(rows, paths);
      return true;
    });
  }

 private:
  static constexpr double max_seconds = 3600;  // for a transaction; one over a million rows takes a few minutes

  /// This is on the heap, since this object is on the stack. The thread sanitizer learns that a mutex has ended when
  /// its memory is freed, and would take it for the next one at the same address.
  const std::unique_ptr<Postgres> database_;
};

/// The folder of a restored backup until all of it is there.
fs::path staging_of(const DataPaths& paths) { return paths.folder / "restoring"; }

/// The folder of a restored backup, which begins empty and is deleted at the end.
class Staging {
 public:
  explicit Staging(const DataPaths& store) : paths_{staging_of(store)} { fs::remove_all(paths_.folder); }
  ~Staging() {
    std::error_code ignored;
    fs::remove_all(paths_.folder, ignored);
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;
  const DataPaths& paths() const { return paths_; }

 private:
  const DataPaths paths_;
};

std::vector<fs::path> content_of_shared(const DataPaths& paths) {
  return content_of(paths, {paths.shared_marker(), staging_of(paths)});
}

bool has_rows(pqxx::work& transaction) {
  return transaction
      .exec1(
          "SELECT EXISTS (SELECT 1 FROM meshes) OR EXISTS (SELECT 1 FROM families) OR EXISTS (SELECT 1 FROM jobs)")[0]
      .as<bool>();
}

void require_empty_store(pqxx::work& transaction, const DataPaths& paths) {
  if (has_rows(transaction)) throw StoreUnavailable("There is something in the database already.");
  if (!content_of_shared(paths).empty())
    throw StoreUnavailable("There is something in " + paths.folder.string() + " already.");
}

/// File name without its suffix in a restored store, in which all fencing tokens are 0.
std::string stem_in_restored(const StoredFile& file) {
  return file.kind == StoredFile::Kind::result ? shared_result_stem(file.id, 0) : file.id;
}

void fail_job(pqxx::work& transaction, const std::string& id, const std::string& problem) {
  constexpr std::int64_t day = 24 * 3600 * 1000;  // milliseconds
  // A job that had not ended has no time of expiry, and gets one.
  transaction.exec_params(
      "UPDATE jobs SET state = 'failed', error = $2, error_status = 500, result_hash = '', bytes = 0, request = NULL, "
      "finished = CASE WHEN finished > 0 THEN finished ELSE $3 END, "
      "expires = CASE WHEN finished > 0 THEN expires ELSE $4 END, revision = revision + 1 WHERE id = $1",
      id, problem, now_milliseconds(), now_milliseconds() + day);
}

class Repair {
 public:
  Repair(pqxx::work& transaction, const DataFolder& folder,
         const std::function<std::string(const std::string&)>& problem)
      : transaction_(transaction), folder_(folder), problem_(problem) {}

  void run() {
    // Takes the jobs from lost servers: what a server that comes back reports about them is refused.
    transaction_.exec0("UPDATE jobs SET holder = '' WHERE finished = 0");
    repair_rows();
    repair_families();
    for (const auto& file : shared_files(transaction_))
      if (const auto fault = fault_on_disk(file, folder_.paths()); !fault.empty()) repair_file(file, fault);
    const auto is_named = [this](const StoredFile& file) {
      return file.kind == StoredFile::Kind::result ? results_.contains(file.stem)
                                                   : is_named_by_shared_rows(transaction_, file);
    };
    for (const auto& file : shared_files(transaction_))
      if (file.kind == StoredFile::Kind::result) results_.insert(file.stem);
    for (const auto& path : orphaned_files(folder_.paths(), is_named)) folder_.quarantine(path);
  }

 private:
  void repair_rows() {
    CheckReport ignored;
    for (const auto& row : faulty_rows(transaction_, ignored)) {
      fail_job(transaction_, row.id, problem_(row.fault));
      if (row.request.empty()) continue;
      const auto file = folder_.paths().request(row.id);
      write_stored_file(file, {row.request});
      folder_.quarantine(file);
    }
  }

  void repair_families() {
    CheckReport ignored;
    for (const auto& [family, fault] : faulty_families(transaction_, ignored)) {
      transaction_.exec_params("DELETE FROM families WHERE id = $1", family.id);
      set_family_aside(folder_, family);
    }
  }

  void repair_file(const StoredFile& file, const std::string& fault) {
    const auto path = file.path(folder_.paths());
    const bool exists = fs::exists(path);
    if (exists && fault_of(file, path.filename().string(), read_file(path)).empty()) {
      const std::string table = file.kind == StoredFile::Kind::mesh ? "meshes" : "jobs";
      transaction_.exec_params("UPDATE " + table + " SET bytes = $2 WHERE id = $1", file.id, bytes_of(path));
      return;
    }
    if (file.kind == StoredFile::Kind::mesh) {
      transaction_.exec_params("DELETE FROM meshes WHERE id = $1", file.id);
    } else {
      fail_job(transaction_, file.id, problem_(fault));
    }
    if (exists) folder_.quarantine(path);
  }

  pqxx::work& transaction_;
  const DataFolder& folder_;
  const std::function<std::string(const std::string&)>& problem_;
  std::set<std::string> results_;  ///< stems of the results that jobs have
};

/// Copies the files of a store in several passes, until few new ones come meanwhile.
void copy_most_files(Copier& copier, MaintenanceDatabase& database) {
  constexpr std::size_t max_new_files = 8;
  constexpr int max_passes = 20;
  for (int pass = 0; pass < max_passes; ++pass) {
    const auto before = copier.copied();
    copier.copy_files(database.catalogue().files());
    if (copier.copied() <= before + max_new_files) return;
  }
}

/// Copies a backup into a folder within the shared folder. Its rows are in an SQLite database there, with the present
/// tables.
CopyReport stage(const DataPaths& from, const DataPaths& staging) {
  make_folders(staging);
  copy_database(from.database(), staging.database());
  Database database(staging.database());
  database.check();
  prepare_tables(database);
  const OwnerTable owners(database);
  fill_missing_byte_counts(database, from);
  Copier copier(from, staging, stem_in_restored);
  const auto missing = copier.copy_files(catalogue_of(database).files());
  return copier.finish(missing);
}

/// Replaces the rows, within a transaction, and the content of the folder by those of a staged backup. If it throws,
/// the folder is as it was.
void replace_store(pqxx::work& transaction, const DataPaths& paths, const DataPaths& staging) {
  const auto replaced_folder = quarantine_folder_of_replaced(paths);
  if (has_rows(transaction)) {
    fs::create_directories(replaced_folder);
    write_rows(transaction, DataPaths{replaced_folder}.database());
  }
  for (const char* table : {"jobs", "meshes", "families"}) transaction.exec0("DELETE FROM " + std::string(table));
  read_rows(transaction, Database(staging.database()));
  Moves moves;
  try {
    for (const auto& path : content_of_shared(paths)) moves.move(path, replaced_folder / path.filename());
    for (const auto& path : content_of(staging, {staging.database()})) moves.move(path, paths.folder / path.filename());
  } catch (...) {
    moves.undo();
    throw;
  }
  make_folders(paths);
}

}  // namespace

CheckReport check_shared_store(const SharedStoreLocation& store) {
  const DataPaths paths{store.folder};
  MaintenanceDatabase database(store);
  database.require_store(paths);
  CheckReport check;
  for (auto& row : database.transaction([&](pqxx::work& rows) {
         check = {};
         return faulty_rows(rows, check);
       }))
    check.faults.push_back(std::move(row.fault));
  for (auto& row : database.transaction([&](pqxx::work& rows) {
         check.families = 0;
         return faulty_families(rows, check);
       }))
    check.faults.push_back(std::move(row.fault));
  check_files(paths, database.catalogue(), check);
  return check;
}

CheckReport repair_shared_store(const SharedStoreLocation& store, const std::function<void(const std::string&)>& warn,
                                const std::function<std::string(const std::string&)>& problem) {
  {
    MaintenanceDatabase database(store);
    database.require_store({store.folder});
    database.transaction([](pqxx::work& transaction) {
      lock_out_servers(transaction);
      return true;
    });
  }
  const DataFolder folder(store.folder, warn);
  auto check = check_shared_store(store);
  // This transaction must not run twice, for files are moved in it. On a new connection, it does not.
  MaintenanceDatabase(store).transaction([&](pqxx::work& transaction) {
    lock_out_servers(transaction);
    Repair(transaction, folder, problem).run();
    return true;
  });
  return check;
}

CopyReport back_up_shared_store(const SharedStoreLocation& store, const fs::path& to) {
  const DataPaths paths{store.folder};
  MaintenanceDatabase database(store);
  database.require_store(paths);
  require_empty(to);
  make_folders({to});
  Copier copier(paths, {to}, stem_in_data_folder);
  copy_most_files(copier, database);
  // A file is deleted as soon as its row is. Therefore the tables are locked until the files that the snapshot names
  // are copied, which are few by now. The rows are read afterwards, from the same snapshot.
  MaintenanceDatabase locking_database(store);
  std::vector<StoredFile> missing;
  database.transaction([&](pqxx::work& snapshot) {
    snapshot.exec0("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ");
    missing = locking_database.transaction([&](pqxx::work& locked) {
      lock_out_changes(locked);
      return copier.copy_files(shared_files(snapshot));
    });
    write_rows(snapshot, DataPaths{to}.database());
    return true;
  });
  auto copy = copier.finish(missing);
  write_backup_marker({to}, copy.files, copy.bytes);
  return copy;
}

CopyReport restore_shared_store(const fs::path& from, const SharedStoreLocation& store, bool replace) {
  require_backup({from});
  const DataFolder folder(store.folder, {});
  const auto& paths = folder.paths();
  {
    Postgres database(store.database, SharedStore::Options().transaction_timeout);
    prepare_shared_tables(database, folder);
  }
  MaintenanceDatabase(store).transaction([&](pqxx::work& transaction) {
    lock_out_servers(transaction);
    if (!replace) require_empty_store(transaction, paths);
    return true;
  });
  const Staging staging(paths);
  auto copy = stage({from}, staging.paths());
  if (replace && !copy.faults.empty())
    throw StoreCorrupted("The backup is damaged, so that nothing was replaced: " + copy.faults.front());
  // This transaction must not run twice, for files are moved in it. On a new connection, it does not.
  MaintenanceDatabase(store).transaction([&](pqxx::work& transaction) {
    lock_out_servers(transaction);
    if (!replace) require_empty_store(transaction, paths);
    replace_store(transaction, paths, staging.paths());
    return true;
  });
  return copy;
}

}  // namespace supple::store
