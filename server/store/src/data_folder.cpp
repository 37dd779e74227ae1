#include "data_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <system_error>
#include <utility>

#include "file_access.h"
#include "supple/store/clock.h"
#include "supple/store/store_error.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Locks the folder for this process alone, for two would run the same jobs; or together with others, where a database
/// tells apart whose jobs are whose.
int take_lock(const DataPaths& paths, DataFolder::Use use) {
  const int descriptor = ::open(paths.lock().c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    throw StoreUnavailable("The data folder " + paths.folder.string() +
                           " is not writable: " + std::generic_category().message(errno) + ".");
  }
  if (::flock(descriptor, (use == DataFolder::Use::alone ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0) {
    ::close(descriptor);
    throw StoreUnavailable("The data folder " + paths.folder.string() + " is in use by another server.");
  }
  return descriptor;
}

}  // namespace

DataFolder::DataFolder(const fs::path& folder, Warn warn, Use use) : paths_{folder}, warn_(std::move(warn)) {
  prepare();
  lock_ = take_lock(paths_, use);
}

DataFolder::~DataFolder() { ::close(lock_); }

/// Makes the folder accessible to the server's user alone, also where an earlier version or an administrator made it.
void DataFolder::prepare() const {
  const auto& folder = paths_.folder;
  const bool existed = fs::exists(folder);
  fs::create_directories(folder);
  const auto before = fs::status(folder).permissions();
  if (before != fs::perms::owner_all) {
    std::error_code error;
    fs::permissions(folder, fs::perms::owner_all, error);
    if (error) {
      warn("the data folder may be entered by others and belongs to another user, so this cannot be changed: " +
           error.message());
    } else if (existed) {
      warn("the data folder could be entered by others, and is for the server's user alone now (mode 0700)");
    }
  }
  for (const auto& subfolder : {paths_.meshes(), paths_.results(), paths_.requests()})
    fs::create_directories(subfolder);
}

void DataFolder::quarantine(const fs::path& file) const {
  const auto folder = paths_.quarantine();
  fs::create_directories(folder);
  const auto name = compact_time() + "-" + file.filename().string();
  auto target = folder / name;
  for (int i = 1; fs::exists(target); ++i) target = folder / (name + "." + std::to_string(i));
  fs::rename(file, target);
  warn("the file " + file.filename().string() + " is moved to quarantine/" + target.filename().string());
}

void DataFolder::try_to_quarantine(const fs::path& file) const {
  try {
    quarantine(file);
  } catch (const fs::filesystem_error& error) {
    warn("the file " + file.filename().string() + " is unknown and cannot be moved: " + error.code().message());
  }
}

bool is_unfinished(const fs::path& path) { return path.extension() == unfinished_suffix; }

std::int64_t modification_time(const fs::path& path) {
  const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path);
  return now_milliseconds() - std::chrono::duration_cast<std::chrono::milliseconds>(age).count();
}

std::string compact_time() {
  const auto seconds = static_cast<std::time_t>(now_milliseconds() / 1000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 20> text{};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &parts)};
}

}  // namespace supple::store
