#pragma once

#include <cstdint>
#include <filesystem>

namespace supple::store {

/// Space of the file system that a folder is on, in bytes.
struct DiskSpace {
  std::int64_t free = 0;  ///< bytes that this process may still use
  std::int64_t size = 0;
};

/// Takes one system call. Throws "store.unavailable" where the folder is gone.
DiskSpace disk_space(const std::filesystem::path& folder);

}  // namespace supple::store
