#include <algorithm>
#include <memory>
#include <set>
#include <system_error>
#include <utility>

#include "backup_marker.h"
#include "copier.h"
#include "data_folder.h"
#include "file_access.h"
#include "look_through.h"
#include "postgres.h"
#include "replaced_content.h"
#include "schema.h"
#include "shared_rows.h"
#include "shared_schema.h"
#include "supple/base/error.h"
#include "supple/store/maintenance.h"
#include "supple/store/shared_store.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// The database of a shared store, for transactions that look at all rows of it.
class AllRows {
 public:
  explicit AllRows(const SharedPlace& store) : database_(std::make_unique<Postgres>(store.database, seconds)) {}

  /// Does what Postgres::transaction does, without the limits of time that a server has.
  template <class Work>
  auto transaction(const Work& work) {
    return database_->transaction([&](pqxx::work& transaction) {
      transaction.exec0("SET LOCAL statement_timeout = 0");
      transaction.exec0("SET LOCAL idle_in_transaction_session_timeout = 0");
      return work(transaction);
    });
  }

  /// What the rows say now, for each call anew. This object outlives it.
  Catalogue catalogue() {
    return {[this] { return transaction([](pqxx::work& rows) { return shared_files(rows); }); },
            [this](const StoredFile& file) {
              return transaction([&](pqxx::work& rows) { return shared_rows_name(rows, file); });
            }};
  }

  void require_store(const Places& places) {
    transaction([&](pqxx::work& rows) {
      require_shared_tables(rows, places);
      return true;
    });
  }

 private:
  static constexpr double seconds = 3600;  // of a transaction; a million rows take one of a few minutes

  /// Not within this object, which is on the stack: the thread sanitizer learns that a mutex has ended when its memory
  /// is freed, and would take it for the next one at the same place.
  const std::unique_ptr<Postgres> database_;
};

/// Where a restored backup waits until all of it is there.
fs::path staging_of(const Places& places) { return places.folder / "restoring"; }

/// That folder, without what an earlier restoration left, and gone at the end.
class Staging {
 public:
  explicit Staging(const Places& store) : places_{staging_of(store)} { fs::remove_all(places_.folder); }
  ~Staging() {
    std::error_code ignored;
    fs::remove_all(places_.folder, ignored);
  }
  Staging(const Staging&) = delete;
  Staging& operator=(const Staging&) = delete;
  const Places& places() const { return places_; }

 private:
  const Places places_;
};

std::vector<fs::path> content_of_shared(const Places& places) {
  return content_of(places, {places.shared_mark(), staging_of(places)});
}

bool has_rows(pqxx::work& transaction) {
  return transaction.exec1("SELECT EXISTS (SELECT 1 FROM meshes) OR EXISTS (SELECT 1 FROM jobs)")[0].as<bool>();
}

void require_empty_store(pqxx::work& transaction, const Places& places) {
  if (has_rows(transaction)) throw Error("store.unavailable", "There is something in the database already.");
  if (!content_of_shared(places).empty())
    throw Error("store.unavailable", "There is something in " + places.folder.string() + " already.");
}

/// A restored job was held by none yet.
std::string stem_in_restored(const StoredFile& file) {
  return file.kind == StoredFile::Kind::result ? shared_result_stem(file.id, 0) : file.id;
}

void fail_job(pqxx::work& transaction, const std::string& id, const std::string& problem) {
  constexpr std::int64_t day = 24 * 3600 * 1000;  // milliseconds
  // One that had not ended has no time at which its row expires.
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
    // What a server that was lost still says of its jobs is refused, whenever it comes back.
    transaction_.exec0("UPDATE jobs SET holder = '' WHERE finished = 0");
    repair_rows();
    for (const auto& file : shared_files(transaction_))
      if (const auto fault = fault_on_disk(file, folder_.places()); !fault.empty()) repair_file(file, fault);
    const auto is_named = [this](const StoredFile& file) {
      return file.kind == StoredFile::Kind::result ? results_.contains(file.stem)
                                                   : shared_rows_name(transaction_, file);
    };
    for (const auto& file : shared_files(transaction_))
      if (file.kind == StoredFile::Kind::result) results_.insert(file.stem);
    for (const auto& path : unknown_files(folder_.places(), is_named)) folder_.quarantine(path);
  }

 private:
  void repair_rows() {
    Check ignored;
    for (const auto& row : faulty_rows(transaction_, ignored)) {
      fail_job(transaction_, row.id, problem_(row.fault));
      if (row.request.empty()) continue;
      const auto file = folder_.places().request(row.id);
      write_stored_file(file, {row.request});
      folder_.quarantine(file);
    }
  }

  void repair_file(const StoredFile& file, const std::string& fault) {
    const auto path = file.place(folder_.places());
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
  std::set<std::string> results_;  ///< stems of those that jobs have
};

/// Copies the files that a store has, again and again until few have come meanwhile.
void copy_most_files(Copier& copier, AllRows& database) {
  constexpr std::size_t few = 8;
  constexpr int max_rounds = 20;
  for (int round = 0; round < max_rounds; ++round) {
    const auto before = copier.copied();
    copier.copy_files(database.catalogue().files());
    if (copier.copied() <= before + few) return;
  }
}

/// Copies a backup beside the content of a shared folder. Its rows are in a database there, with the present tables.
Copy stage(const Places& from, const Places& staging) {
  make_folders(staging);
  copy_database(from.database(), staging.database());
  Database database(staging.database());
  database.check();
  prepare_tables(database);
  const OwnerTable owners(database);
  count_bytes_of_rows(database, from);
  Copier copier(from, staging, stem_in_restored);
  const auto missing = copier.copy_files(catalogue_of(database).files());
  return copier.finish(missing);
}

/// Makes the rows of a transaction and the content of a folder those of a staged backup. Where it throws, the folder is
/// as it was.
void replace_store(pqxx::work& transaction, const Places& places, const Places& staging) {
  const auto aside = place_of_replaced(places);
  if (has_rows(transaction)) {
    fs::create_directories(aside);
    write_rows(transaction, Places{aside}.database());
  }
  for (const char* table : {"jobs", "meshes"}) transaction.exec0("DELETE FROM " + std::string(table));
  read_rows(transaction, Database(staging.database()));
  Moves moves;
  try {
    for (const auto& path : content_of_shared(places)) moves.move(path, aside / path.filename());
    for (const auto& path : content_of(staging, {staging.database()}))
      moves.move(path, places.folder / path.filename());
  } catch (...) {
    moves.undo();
    throw;
  }
  make_folders(places);
}

}  // namespace

Check check_shared_store(const SharedPlace& store) {
  const Places places{store.folder};
  AllRows database(store);
  database.require_store(places);
  Check check;
  for (auto& row : database.transaction([&](pqxx::work& rows) {
         check = {};
         return faulty_rows(rows, check);
       }))
    check.faults.push_back(std::move(row.fault));
  look_through(places, database.catalogue(), check);
  return check;
}

Check repair_shared_store(const SharedPlace& store, const std::function<void(const std::string&)>& warn,
                          const std::function<std::string(const std::string&)>& problem) {
  {
    AllRows database(store);
    database.require_store({store.folder});
    database.transaction([](pqxx::work& transaction) {
      keep_servers_away(transaction);
      return true;
    });
  }
  const DataFolder folder(store.folder, warn);
  auto check = check_shared_store(store);
  // On a connection of its own, for a transaction is run again only on one that was there before, and files are moved.
  AllRows(store).transaction([&](pqxx::work& transaction) {
    keep_servers_away(transaction);
    Repair(transaction, folder, problem).run();
    return true;
  });
  return check;
}

Copy back_up_shared_store(const SharedPlace& store, const fs::path& to) {
  const Places places{store.folder};
  AllRows database(store);
  database.require_store(places);
  require_empty(to);
  make_folders({to});
  Copier copier(places, {to}, stem_in_data_folder);
  copy_most_files(copier, database);
  // Files go as soon as their rows do, so that no row changes until those that the snapshot names are copied. They are
  // few by now. The rows are read afterwards, from the same snapshot.
  AllRows lock(store);
  std::vector<StoredFile> missing;
  database.transaction([&](pqxx::work& snapshot) {
    snapshot.exec0("SET TRANSACTION ISOLATION LEVEL REPEATABLE READ");
    missing = lock.transaction([&](pqxx::work& still) {
      still.exec0("LOCK TABLE meshes, mesh_owners, jobs IN SHARE MODE");
      return copier.copy_files(shared_files(snapshot));
    });
    write_rows(snapshot, Places{to}.database());
    return true;
  });
  auto copy = copier.finish(missing);
  write_backup_marker({to}, copy.files, copy.bytes);
  return copy;
}

Copy restore_shared_store(const fs::path& from, const SharedPlace& store, bool replace) {
  require_backup({from});
  const DataFolder folder(store.folder, {});
  const auto& places = folder.places();
  {
    Postgres database(store.database, SharedStore::Options().patience);
    prepare_shared_tables(database, folder);
  }
  AllRows(store).transaction([&](pqxx::work& transaction) {
    keep_servers_away(transaction);
    if (!replace) require_empty_store(transaction, places);
    return true;
  });
  const Staging staging(places);
  auto copy = stage({from}, staging.places());
  if (replace && !copy.faults.empty())
    throw Error("store.corrupted", "The backup is damaged, so that nothing was replaced: " + copy.faults.front());
  // On a connection of its own, for a transaction is run again only on one that was there before, and files are moved.
  AllRows(store).transaction([&](pqxx::work& transaction) {
    keep_servers_away(transaction);
    if (!replace) require_empty_store(transaction, places);
    replace_store(transaction, places, staging.places());
    return true;
  });
  return copy;
}

}  // namespace supple::store
