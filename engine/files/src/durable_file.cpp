#include "supple/files/durable_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "supple/base/error.h"

namespace supple::files {
namespace {

void synchronize(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) throw_write_failed("open", path);
  const int status = ::fsync(descriptor);
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  if (status != 0) throw_write_failed("synchronize", path);
}

}  // namespace

void throw_write_failed(const std::string& action, const std::filesystem::path& path) {
  throw Error("file.write_failed",
              "Cannot " + action + " " + path.string() + ": " + std::generic_category().message(errno) + ".");
}

void append_durably(int descriptor, std::string_view bytes, const std::filesystem::path& path) {
  while (!bytes.empty()) {
    const auto count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_write_failed("write", path);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  if (::fsync(descriptor) != 0) throw_write_failed("synchronize", path);
}

void synchronize_folder_of(const std::filesystem::path& path) {
  const auto folder = path.parent_path();
  synchronize(folder.empty() ? std::filesystem::path(".") : folder, O_RDONLY | O_DIRECTORY);
}

void move_into_place(const std::filesystem::path& finished, const std::filesystem::path& place) {
  synchronize(finished, O_RDONLY);
  if (::rename(finished.c_str(), place.c_str()) != 0) throw_write_failed("rename", finished);
  synchronize_folder_of(place);
}

}  // namespace supple::files
