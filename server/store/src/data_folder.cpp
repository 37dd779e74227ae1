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
#include "supple/base/error.h"
#include "supple/store/clock.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// One process at a time, for two would run the same jobs; or those that share a database which tells them apart.
int take_lock(const Places& places, DataFolder::Use use) {
  const int descriptor = ::open(places.lock().c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) {
    throw Error("store.unavailable", "The data folder " + places.folder.string() +
                                         " is not writable: " + std::generic_category().message(errno) + ".");
  }
  if (::flock(descriptor, (use == DataFolder::Use::alone ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0) {
    ::close(descriptor);
    throw Error("store.unavailable", "The data folder " + places.folder.string() + " is in use by another server.");
  }
  return descriptor;
}

}  // namespace

DataFolder::DataFolder(const fs::path& folder, Warn warn, Use use) : places_{folder}, warn_(std::move(warn)) {
  prepare();
  lock_ = take_lock(places_, use);
}

DataFolder::~DataFolder() { ::close(lock_); }

/// For the server's user alone, also where an earlier version or an administrator made the folder.
void DataFolder::prepare() const {
  const auto& folder = places_.folder;
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
  for (const auto& subfolder : {places_.meshes(), places_.results(), places_.requests()})
    fs::create_directories(subfolder);
}

void DataFolder::quarantine(const fs::path& file) const {
  const auto folder = places_.quarantine();
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

std::int64_t modified(const fs::path& path) {
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
