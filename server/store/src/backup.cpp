#include <algorithm>
#include <vector>

#include "backup_marker.h"
#include "copier.h"
#include "data_folder.h"
#include "database.h"
#include "replaced_content.h"
#include "stored_files.h"
#include "supple/store/maintenance.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Copies the database as it is now, and then the files that it names. Meanwhile jobs may end or be removed, and their
/// files with them. Therefore the database is copied again, and with it the new files, until no file is missing, or
/// only files that the original database still names. Those are faults. Each pass has less to copy.
CopyReport copy(const DataPaths& from, const DataPaths& to) {
  const Database original(from.database());
  const auto rows = catalogue_of(original);
  const auto is_outdated = [&](const StoredFile& file) { return !rows.contains(file) || fs::exists(file.path(from)); };
  Copier copier(from, to, stem_in_data_folder);
  std::vector<StoredFile> missing;
  constexpr int max_passes = 100;  // one suffices if nothing ends meanwhile; mostly there are two or three
  for (int pass = 0; pass < max_passes; ++pass) {
    copy_database(from.database(), to.database());
    const Database database(to.database());
    missing = copier.copy_files(catalogue_of(database).files());
    if (std::none_of(missing.begin(), missing.end(), is_outdated)) break;
  }
  return copier.finish(missing);
}

}  // namespace

CopyReport back_up(const fs::path& folder, const fs::path& to) {
  const DataPaths from{folder};
  if (!fs::exists(from.database())) throw StoreUnavailable("There is no database in " + folder.string() + ".");
  require_empty(to);
  make_folders({to});
  auto copied = copy(from, {to});
  write_backup_marker({to}, copied.files, copied.bytes);
  return copied;
}

CopyReport restore(const fs::path& from, const fs::path& data, bool replace) {
  require_backup({from});
  if (!replace) require_empty(data);
  const DataFolder folder(data, {});
  const auto& paths = folder.paths();
  const auto replaced_folder = quarantine_folder_of_replaced(paths);
  Moves moves;
  for (const auto& path : content_of(paths)) moves.move(path, replaced_folder / path.filename());
  make_folders(paths);
  return copy({from}, paths);
}

}  // namespace supple::store
