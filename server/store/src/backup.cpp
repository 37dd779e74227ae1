#include <algorithm>
#include <vector>

#include "backup_marker.h"
#include "copier.h"
#include "data_folder.h"
#include "database.h"
#include "replaced_content.h"
#include "stored_files.h"
#include "supple/base/error.h"
#include "supple/store/maintenance.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Takes the database as it is now, and then the files that it names. Those go of jobs that end or are removed before
/// their turn comes. So the database is taken again, and with it what has come meanwhile, until nothing is missing but
/// what it still names, which is a fault. Every round has less to copy.
Copy copy(const Places& from, const Places& to) {
  const Database original(from.database());
  const auto rows = catalogue_of(original);
  const auto has_gone = [&](const StoredFile& file) { return !rows.names(file) || fs::exists(file.place(from)); };
  Copier copier(from, to, stem_in_data_folder);
  std::vector<StoredFile> missing;
  constexpr int max_rounds = 100;  // one is enough where nothing ends at the moment, two or three mostly
  for (int round = 0; round < max_rounds; ++round) {
    copy_database(from.database(), to.database());
    const Database database(to.database());
    missing = copier.copy_files(catalogue_of(database).files());
    if (std::none_of(missing.begin(), missing.end(), has_gone)) break;
  }
  return copier.finish(missing);
}

}  // namespace

Copy back_up(const fs::path& folder, const fs::path& to) {
  const Places from{folder};
  if (!fs::exists(from.database()))
    throw Error("store.unavailable", "There is no database in " + folder.string() + ".");
  require_empty(to);
  make_folders({to});
  auto copied = copy(from, {to});
  write_backup_marker({to}, copied.files, copied.bytes);
  return copied;
}

Copy restore(const fs::path& from, const fs::path& data, bool replace) {
  require_backup({from});
  if (!replace) require_empty(data);
  const DataFolder folder(data, {});
  const auto& places = folder.places();
  const auto aside = place_of_replaced(places);
  Moves moves;
  for (const auto& path : content_of(places)) moves.move(path, aside / path.filename());
  make_folders(places);
  return copy({from}, places);
}

}  // namespace supple::store
