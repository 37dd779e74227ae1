#pragma once

#include <cstdint>
#include <filesystem>

namespace supple::store {

/// Of the file system that a folder is on, in bytes.
struct DiskSpace {
  std::int64_t free = 0;  ///< that this process may still use
  std::int64_t size = 0;
};

/// One system call. Throws "store.unavailable" where the folder is gone.
DiskSpace disk_space(const std::filesystem::path& folder);

}  // namespace supple::store
