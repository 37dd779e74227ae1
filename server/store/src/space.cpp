#include "space.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <string>
#include <system_error>

#include "file_access.h"
#include "supple/problem/problem.h"

namespace supple::store {
namespace {

namespace fs = std::filesystem;

/// Bytes by which the rows of a new file let the database's log grow: a few pages each.
constexpr std::int64_t bytes_of_rows = 64 << 10;

constexpr std::array<std::string_view, 4> names{"mesh", "result", "request", "family"};

/// Bytes of the files in a folder and below it. Files that vanish meanwhile do not count.
std::int64_t bytes_of_files(const fs::path& folder) {
  std::int64_t sum = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code gone;
    if (entry->is_regular_file(gone)) sum += bytes_of(entry->path());
  }
  return sum;
}

[[noreturn]] void throw_quota(const std::string& code, const std::string& detail, std::int64_t limit,
                              std::int64_t value, const std::string& setting) {
  throw problem::ProblemError({code,
                               detail + " (setting " + setting + ").",
                               {},
                               problem::Limit{static_cast<double>(limit), static_cast<double>(value), setting},
                               {}});
}

}  // namespace

std::int64_t default_quota(const fs::path& folder) {
  std::error_code error;
  auto existing = fs::absolute(folder, error);
  while (!fs::exists(existing, error) && existing.has_relative_path()) existing = existing.parent_path();
  const auto space = fs::space(existing, error);
  return error ? 0 : static_cast<std::int64_t>(space.capacity / 10 * 9);
}

std::int64_t& bytes_of_category(Usage& usage, Category category) {
  switch (category) {
    case Category::meshes:
      return usage.meshes;
    case Category::results:
      return usage.results;
    case Category::requests:
      return usage.requests;
    default:
      return usage.database;
  }
}

void UsageCounter::count() {
  Usage counted;
  counted.meshes = bytes_of_files(paths_.meshes());
  counted.results = bytes_of_files(paths_.results());
  counted.requests = bytes_of_files(paths_.requests());
  counted.quarantine = bytes_of_files(paths_.quarantine());
  const std::lock_guard lock(mutex_);
  counted_ = counted;
}

void UsageCounter::count_quarantine() {
  const auto bytes = bytes_of_files(paths_.quarantine());
  const std::lock_guard lock(mutex_);
  counted_.quarantine = bytes;
}

void UsageCounter::add(Category category, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  bytes_of_category(counted_, category) += bytes;
}

Usage UsageCounter::measured() const {
  auto usage = counted_;
  usage.limit = quota_.bytes;
  usage.mesh_limit = quota_.mesh_bytes;
  const auto database = paths_.database().string();
  for (const char* suffix : {"", "-wal", "-shm"}) usage.database += bytes_of(database + suffix);
  usage.database += bytes_of(paths_.reserve());
  return usage;
}

Usage UsageCounter::usage() const {
  const std::lock_guard lock(mutex_);
  return measured();
}

std::int64_t UsageCounter::try_add(Category category, std::int64_t bytes) {
  const std::lock_guard lock(mutex_);
  const auto excess = excess_bytes(measured(), category, bytes);
  if (excess == 0) bytes_of_category(counted_, category) += bytes;
  return excess;
}

std::int64_t excess_bytes(const Usage& usage, Category category, std::int64_t bytes) {
  if (category == Category::meshes && usage.mesh_limit > 0 && usage.meshes + bytes > usage.mesh_limit) {
    const auto value = usage.meshes + bytes;
    throw_quota("store.quota",
                "With this mesh of " + std::to_string(bytes) + " bytes all meshes would take " + std::to_string(value) +
                    " bytes, their limit is " + std::to_string(usage.mesh_limit),
                usage.mesh_limit, value, "--max-mesh-bytes");
  }
  if (usage.limit <= 0) return 0;
  const auto excess = usage.total() + bytes + bytes_of_rows - usage.limit;
  // Nothing is removed if the bytes would not even fit without all results.
  if (excess > usage.results) refuse_store(usage, category, bytes);
  return std::max<std::int64_t>(excess, 0);
}

void refuse_store(const Usage& usage, Category category, std::int64_t bytes) {
  const auto value = usage.total() + bytes + bytes_of_rows;
  throw_quota("store.quota",
              "With this " + std::string(names.at(static_cast<std::size_t>(category))) + " of " +
                  std::to_string(bytes) + " bytes and its rows the data folder would hold " + std::to_string(value) +
                  " bytes, its limit is " + std::to_string(usage.limit) + "; meshes take " +
                  std::to_string(usage.meshes) + ", results " + std::to_string(usage.results) + ", requests of jobs " +
                  std::to_string(usage.requests) + ", the database " + std::to_string(usage.database) +
                  " and what is in quarantine " + std::to_string(usage.quarantine),
              usage.limit, value, "--max-store");
}

void refuse_owner(const std::string& owner, const OwnerUsage& owner_usage, Category category, std::int64_t bytes,
                  std::int64_t limit) {
  const auto value = owner_usage.total() + bytes;
  throw_quota("store.key_quota",
              "With this " + std::string(names.at(static_cast<std::size_t>(category))) + " of " +
                  std::to_string(bytes) + " bytes the key " + owner + " would hold " + std::to_string(value) +
                  " bytes, its limit is " + std::to_string(limit) + "; its meshes take " +
                  std::to_string(owner_usage.meshes) + ", its families " + std::to_string(owner_usage.families) +
                  ", its results " + std::to_string(owner_usage.results) + " and requests of its jobs " +
                  std::to_string(owner_usage.requests),
              limit, value, "--max-stored");
}

void Reserve::refill() noexcept {
  if (bytes_of(file_) == bytes) return;
  const int descriptor = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor < 0) return;
  const bool allocated = ::posix_fallocate(descriptor, 0, bytes) == 0;
  ::close(descriptor);
  if (!allocated) ::unlink(file_.c_str());
}

bool Reserve::release() noexcept { return ::unlink(file_.c_str()) == 0; }

}  // namespace supple::store
