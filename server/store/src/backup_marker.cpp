#include "backup_marker.h"

#include "checked_content.h"
#include "file_access.h"
#include "supple/store/store.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

constexpr std::string_view database_hash_prefix = "supple.sqlite sha256 ";

std::string with_hash(std::string first_line, const DataPaths& backup) {
  return first_line.append("\n").append(database_hash_prefix).append(sha256(read_file(backup.database()))).append("\n");
}

}  // namespace

void write_backup_marker(const DataPaths& backup, std::size_t files, std::int64_t bytes) {
  write_stored_file(backup.backup_marker(),
                    {with_hash("supple-server backup of " + compact_time() + ": " + std::to_string(files) + " files, " +
                                   std::to_string(bytes) + " bytes",
                               backup)});
}

void renew_backup_marker(const DataPaths& folder) {
  if (!std::filesystem::exists(folder.backup_marker())) return;
  const auto text = read_file(folder.backup_marker());
  write_stored_file(folder.backup_marker(), {with_hash(text.substr(0, text.find('\n')), folder)});
}

void require_backup(const DataPaths& folder) {
  if (!std::filesystem::exists(folder.database()))
    throw StoreUnavailable("There is no database in " + folder.folder.string() + ".");
  if (!std::filesystem::exists(folder.backup_marker())) {
    throw StoreUnavailable("The folder " + folder.folder.string() +
                           " is no complete backup: it has no file named \"backup\".");
  }
  const auto text = read_file(folder.backup_marker());
  const auto found = text.find(database_hash_prefix);
  if (found == std::string::npos) return;
  const auto begin = found + database_hash_prefix.size();
  open_checked(folder.database(), {}, text.substr(begin, text.find('\n', begin) - begin), {});
}

}  // namespace supple::store
