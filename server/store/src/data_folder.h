#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace supple::store {

/// Where a store keeps what: the places of a data folder. Nothing is looked up; any folder may be asked.
struct Places {
  std::filesystem::path folder;

  std::filesystem::path database() const { return folder / "supple.sqlite"; }
  std::filesystem::path lock() const { return folder / "lock"; }
  std::filesystem::path reserve() const { return folder / "reserve"; }
  std::filesystem::path backup_marker() const { return folder / "backup"; }
  /// Names the database that a shared folder belongs to.
  std::filesystem::path shared_mark() const { return folder / "shared-store"; }
  std::filesystem::path meshes() const { return folder / "meshes"; }
  std::filesystem::path results() const { return folder / "results"; }
  std::filesystem::path requests() const { return folder / "requests"; }
  std::filesystem::path quarantine() const { return folder / "quarantine"; }
  std::filesystem::path mesh(const std::string& id) const { return meshes() / (id + ".ply"); }
  std::filesystem::path result(const std::string& id) const { return results() / (id + ".result"); }
  std::filesystem::path request(const std::string& id) const { return requests() / (id + ".request"); }
};

/// A data folder that this process uses for the lifetime of the object, alone or with others that share it: for the
/// server's user alone (mode 0700), with its subfolders, and with a place for what is not understood.
class DataFolder {
 public:
  using Warn = std::function<void(const std::string&)>;

  enum class Use { alone, shared };

  /// Makes what does not exist. Throws "store.unavailable" where another process has it, unless both share it, and
  /// std::filesystem::filesystem_error.
  DataFolder(const std::filesystem::path& folder, Warn warn, Use use = Use::alone);
  ~DataFolder();
  DataFolder(const DataFolder&) = delete;
  DataFolder& operator=(const DataFolder&) = delete;

  const Places& places() const { return places_; }
  void warn(const std::string& text) const {
    if (warn_) warn_(text);
  }

  /// Moves a file into the folder of what is not understood, under a name that says when. Throws
  /// std::filesystem::filesystem_error.
  void quarantine(const std::filesystem::path& file) const;
  /// For a file that the server can do without: where it cannot be moved, as on a full disk, it stays.
  void try_to_quarantine(const std::filesystem::path& file) const;

 private:
  void prepare() const;

  const Places places_;
  const Warn warn_;
  int lock_ = -1;
};

/// Whether write_stored_file left it: the process ended before the file was complete.
bool is_unfinished(const std::filesystem::path& path);

/// When the content of a file changed last, in milliseconds since 1970.
std::int64_t modified(const std::filesystem::path& path);

/// "20260131T235959Z", in UTC.
std::string compact_time();

}  // namespace supple::store
