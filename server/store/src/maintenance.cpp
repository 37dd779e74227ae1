#include "supple/store/maintenance.h"

#include "backup_marker.h"
#include "data_folder.h"
#include "database.h"
#include "file_check.h"
#include "recovery.h"
#include "schema.h"
#include "stored_files.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Checks a folder that will be repaired. A lost database is then one of the faults, for the files are still there.
CheckReport check_before_repair(const fs::path& folder) {
  const DataPaths paths{folder};
  if (fs::exists(paths.database()) || !fs::exists(paths.meshes()) || !fs::exists(paths.results()))
    return check_folder(folder);
  CheckReport check;
  check.faults.push_back("There is no database in " + folder.string() + ".");
  return check;
}

/// The rows of families that do not have their hash. The families are counted in `check`.
std::vector<FaultyFamily> faulty_families(const Database& database, CheckReport& check) {
  std::vector<FaultyFamily> faulty;
  for (Statement row(database, "SELECT " + family_columns() + " FROM families ORDER BY sequence"); row.step();) {
    ++check.families;
    auto family = read_family(row);
    if (auto fault = fault_of_family(family, row.text(6)); !fault.empty())
      faulty.push_back({std::move(family), std::move(fault)});
  }
  return faulty;
}

void repair(const DataFolder& folder, const LocalStore::Recovery& recovery,
            const std::function<std::string(const std::string&)>& problem) {
  bool is_new = false;
  const auto database = open_database(folder, is_new);
  recover_files(folder, *database, recovery, is_new);
  CheckReport ignored;
  for (const auto& [family, fault] : faulty_families(*database, ignored)) {
    Statement(*database, "DELETE FROM families WHERE id = ?").bind(family.id).run();
    set_family_aside(folder, family);
  }
  for (const auto& file : catalogue_of(*database).files()) {
    const auto fault = fault_on_disk(file, folder.paths());
    if (fault.empty()) continue;
    if (file.kind == StoredFile::Kind::mesh) {
      Statement(*database, "DELETE FROM meshes WHERE id = ?").bind(file.id).run();
    } else if (file.kind == StoredFile::Kind::result) {
      Statement(
          *database,
          "UPDATE jobs SET state = 'failed', error = ?, error_status = 500, result_hash = '', bytes = 0 WHERE id = ?")
          .bind(problem(fault))
          .bind(file.id)
          .run();
    }
    const auto path = file.path(folder.paths());
    if (fs::exists(path)) folder.quarantine(path);
  }
}

}  // namespace

CheckReport check_folder(const fs::path& folder) {
  const DataPaths paths{folder};
  if (!fs::exists(paths.database())) throw StoreUnavailable("There is no database in " + folder.string() + ".");
  CheckReport check;
  try {
    const Database database(paths.database());
    database.check();
    if (has_table(database, "families"))
      for (auto& row : faulty_families(database, check)) check.faults.push_back(std::move(row.fault));
    check_files(paths, catalogue_of(database), check);
  } catch (const DamagedDatabase& error) {
    check.faults.emplace_back(error.what());
  }
  return check;
}

CheckReport repair_folder(const fs::path& data, const LocalStore::Recovery& recovery,
                          const std::function<std::string(const std::string&)>& problem) {
  auto check = check_before_repair(data);
  const DataFolder folder(data, recovery.warn);
  repair(folder, recovery, problem);
  renew_backup_marker(folder.paths());
  return check;
}

}  // namespace supple::store
