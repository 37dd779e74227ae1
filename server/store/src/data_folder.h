#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace supple::store {

/// The paths in a data folder. They are computed from its name, without access to the disk.
struct DataPaths {
  std::filesystem::path folder;

  std::filesystem::path database() const { return folder / "supple.sqlite"; }
  std::filesystem::path lock() const { return folder / "lock"; }
  std::filesystem::path reserve() const { return folder / "reserve"; }
  std::filesystem::path backup_marker() const { return folder / "backup"; }
  /// The file with the id of the database that a shared folder belongs to.
  std::filesystem::path shared_marker() const { return folder / "shared-store"; }
  std::filesystem::path meshes() const { return folder / "meshes"; }
  std::filesystem::path results() const { return folder / "results"; }
  std::filesystem::path requests() const { return folder / "requests"; }
  std::filesystem::path quarantine() const { return folder / "quarantine"; }
  std::filesystem::path mesh(const std::string& id) const { return meshes() / (id + ".ply"); }
  std::filesystem::path result(const std::string& id) const { return results() / (id + ".result"); }
  std::filesystem::path request(const std::string& id) const { return requests() / (id + ".request"); }
};

/// A data folder that this process has locked for the lifetime of the object, alone or together with others that share
/// it. Only the server's user may enter it (mode 0700). It has a subfolder for each kind of file, and one for
/// quarantine.
class DataFolder {
 public:
  using Warn = std::function<void(const std::string&)>;

  enum class Use { alone, shared };

  /// Makes folders that do not exist. Throws "store.unavailable" where another process has the folder, unless both
  /// share it, and std::filesystem::filesystem_error.
  DataFolder(const std::filesystem::path& folder, Warn warn, Use use = Use::alone);
  ~DataFolder();
  DataFolder(const DataFolder&) = delete;
  DataFolder& operator=(const DataFolder&) = delete;

  const DataPaths& paths() const { return paths_; }
  void warn(const std::string& text) const {
    if (warn_) warn_(text);
  }

  /// Moves a file into the subfolder "quarantine", under a name that begins with the time. Throws
  /// std::filesystem::filesystem_error.
  void quarantine(const std::filesystem::path& file) const;
  /// Does the same for a file that the server can do without. If it cannot be moved, as on a full disk, it stays where
  /// it is.
  void try_to_quarantine(const std::filesystem::path& file) const;

 private:
  void prepare() const;

  const DataPaths paths_;
  const Warn warn_;
  int lock_ = -1;
};

/// Whether a file is one that write_stored_file did not complete, because the process ended.
bool is_unfinished(const std::filesystem::path& path);

/// Time of the last change of a file's content, in milliseconds since 1970.
std::int64_t modification_time(const std::filesystem::path& path);

/// The present time in UTC, as in "20260131T235959Z".
std::string compact_time();

}  // namespace supple::store
