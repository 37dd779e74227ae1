#include "supple/store/maintenance.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

#include "data_folder.h"
#include "database.h"
#include "file_access.h"
#include "recovery.h"
#include "schema.h"
#include "stored_files.h"
#include "supple/base/error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;
using Kind = StoredFile::Kind;

/// Empty where the file is as it should be.
std::string fault_on_disk(const StoredFile& file, const Places& places) {
  const auto path = file.place(places);
  try {
    return fault_of(file, path.filename().string(), read_file(path));
  } catch (const Error& error) {
    return error.what();
  }
}

bool is_named(const Database& database, const StoredFile& file) {
  const char* const query = file.kind == Kind::mesh     ? "SELECT 1 FROM meshes WHERE id = ?"
                            : file.kind == Kind::result ? "SELECT 1 FROM jobs WHERE id = ? AND result_hash <> ''"
                                                        : "SELECT 1 FROM jobs WHERE id = ? AND finished = 0";
  Statement row(database, query);
  return row.bind(file.id).step();
}

void count(const StoredFile& file, Check& check) {
  ++(file.kind == Kind::mesh ? check.meshes : file.kind == Kind::result ? check.results : check.requests);
}

/// The files in the folder that the database does not name.
std::vector<fs::path> unknown_files(const Places& places, const Database& database, const std::set<fs::path>& known) {
  std::vector<fs::path> unknown;
  for (const auto& [kind, folder, suffix] :
       {std::tuple(Kind::mesh, places.meshes(), ".ply"), std::tuple(Kind::result, places.results(), ".result"),
        std::tuple(Kind::request, places.requests(), ".request")}) {
    if (!fs::exists(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) {
      const auto& path = entry.path();
      if (is_unfinished(path) || known.contains(path)) continue;
      if (path.extension() != suffix || !is_named(database, {kind, path.stem().string(), {}})) unknown.push_back(path);
    }
  }
  return unknown;
}

/// What a server adds or removes at the moment is there before its row is, or after it: that is looked at twice.
void find_unknown(const Places& places, const Database& database, const std::set<fs::path>& known, Check& check) {
  const auto first = unknown_files(places, database, known);
  if (first.empty()) return;
  constexpr std::chrono::milliseconds between_file_and_row{500};
  std::this_thread::sleep_for(between_file_and_row);
  const auto second = unknown_files(places, database, known);
  for (const auto& path : first) {
    if (std::find(second.begin(), second.end(), path) == second.end()) continue;
    check.faults.push_back("The database does not name the file " + path.filename().string() + ".");
  }
}

/// Also where the database is lost: the files are still there.
Check check_before_repair(const fs::path& folder) {
  const Places places{folder};
  if (fs::exists(places.database()) || !fs::exists(places.meshes()) || !fs::exists(places.results()))
    return check_folder(folder);
  Check check;
  check.faults.push_back("There is no database in " + folder.string() + ".");
  return check;
}

}  // namespace

Check check_folder(const fs::path& folder) {
  const Places places{folder};
  if (!fs::exists(places.database()))
    throw Error("store.unavailable", "There is no database in " + folder.string() + ".");
  Check check;
  try {
    const Database database(places.database());
    database.check();
    std::set<fs::path> known;
    for (const auto& file : stored_files(database)) {
      known.insert(file.place(places));
      auto fault = fault_on_disk(file, places);
      // What has gone meanwhile is no fault; nor is what a repair by a client has put right.
      if (!fault.empty()) fault = is_named(database, file) ? fault_on_disk(file, places) : std::string();
      if (!fault.empty() && !is_named(database, file)) continue;
      count(file, check);
      if (!fault.empty()) check.faults.push_back(std::move(fault));
    }
    find_unknown(places, database, known, check);
  } catch (const DamagedDatabase& error) {
    check.faults.emplace_back(error.what());
  }
  return check;
}

Check repair_folder(const fs::path& data, const LocalStore::Recovery& recovery,
                    const std::function<std::string(const std::string&)>& problem) {
  auto check = check_before_repair(data);
  const DataFolder folder(data, recovery.warn);
  bool is_new = false;
  const auto database = open_database(folder, is_new);
  recover_files(folder, *database, recovery, is_new);
  for (const auto& file : stored_files(*database)) {
    const auto fault = fault_on_disk(file, folder.places());
    if (fault.empty()) continue;
    if (file.kind == Kind::mesh) {
      Statement(*database, "DELETE FROM meshes WHERE id = ?").bind(file.id).run();
    } else if (file.kind == Kind::result) {
      Statement(
          *database,
          "UPDATE jobs SET state = 'failed', error = ?, error_status = 500, result_hash = '', bytes = 0 WHERE id = ?")
          .bind(problem(fault))
          .bind(file.id)
          .run();
    }
    const auto path = file.place(folder.places());
    if (fs::exists(path)) folder.quarantine(path);
  }
  return check;
}

}  // namespace supple::store
