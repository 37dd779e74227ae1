#include "supple/store/disk_space.h"

#include <string>
#include <system_error>

#include "supple/store/store_error.h"

namespace supple::store {

DiskSpace disk_space(const std::filesystem::path& folder) {
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  if (error) {
    throw StoreUnavailable("The space of the data folder " + folder.string() + " is not known: " + error.message() +
                           ".");
  }
  return {static_cast<std::int64_t>(space.available), static_cast<std::int64_t>(space.capacity)};
}

}  // namespace supple::store
